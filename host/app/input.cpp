#include "host/app/input.hpp"

namespace enamel::app {

Result<calib::Rig> rig_for(const std::string& rig_path, const host::BurstStream& stream, const std::string& input) {
  if (!rig_path.empty()) return calib::load_rig(rig_path);
  if (stream.rig_text().empty()) return fail(ErrorCode::kRigMissing, input);
  return calib::parse_rig(stream.rig_text());
}

std::string attached_text(host::BurstStream& stream, const std::string& name) {
  const auto bytes = stream.attachment(name);
  return bytes ? std::string(bytes->begin(), bytes->end()) : std::string();
}

}  // namespace enamel::app
