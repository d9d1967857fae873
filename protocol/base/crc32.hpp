// CRC-32 with the polynomial of zlib, PNG and MCAP (reflected 0xEDB88320).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace enamel {

/// CRC of `bytes` continued from `previous`: crc32(b, crc32(a)) == crc32(a followed by b). Empty input gives
/// `previous`.
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t previous = 0) noexcept;

}  // namespace enamel
