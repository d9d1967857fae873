#include "calib/model/rig.hpp"

#include <span>
#include <utility>

#include "calib/model/rig_reader.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/base/file.hpp"

namespace enamel::calib {

Result<Rig> parse_rig(std::string text) {
  ENAMEL_TRY_ASSIGN(Rig rig, read_rig_json(text));
  rig.crc32 = enamel::crc32(std::as_bytes(std::span<const char>(text)));
  rig.text = std::move(text);
  return rig;
}

Result<Rig> load_rig(const std::string& path) {
  ENAMEL_TRY_ASSIGN(std::string text, read_file(path));
  auto rig = parse_rig(std::move(text));
  if (!rig) return fail(rig.error().code, path + ": " + rig.error().detail);
  return rig;
}

}  // namespace enamel::calib
