#include "protocol/base/crc32.hpp"

#include <libdeflate.h>

namespace enamel {

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t previous) noexcept {
  if (bytes.empty()) return previous;  // no address: libdeflate would begin anew
  return libdeflate_crc32(previous, bytes.data(), bytes.size());
}

}  // namespace enamel
