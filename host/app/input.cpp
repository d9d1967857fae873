#include "host/app/input.hpp"

namespace enamel::app {

std::string attached_text(host::BurstStream& stream, const std::string& name) {
  const auto bytes = stream.attachment(name);
  return bytes ? std::string(bytes->begin(), bytes->end()) : std::string();
}

}  // namespace enamel::app
