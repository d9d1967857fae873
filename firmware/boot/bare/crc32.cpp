// CRC-32 for a bootloader that has no libdeflate. Takes the place of protocol/base/crc32.cpp there; tests/arm64 holds
// the two against each other.
#include "protocol/base/crc32.hpp"

#include <array>
#include <cstring>

namespace enamel {
namespace {

using Table = std::array<std::uint32_t, 256>;

// Slicing by 8 (Kounavis and Berry 2005): table k advances a byte by k further zero bytes.
constexpr std::array<Table, 8> make_tables() {
  std::array<Table, 8> t{};
  for (std::uint32_t n = 0; n < 256; ++n) {
    std::uint32_t c = n;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0 ? 0xEDB88320U ^ (c >> 1U) : c >> 1U;
    t[0][n] = c;
  }
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t n = 0; n < 256; ++n) t[k][n] = (t[k - 1][n] >> 8U) ^ t[0][t[k - 1][n] & 0xFFU];
  }
  return t;
}

constexpr std::array<Table, 8> kTables = make_tables();

// Little-endian load by shifts: the same on any byte order, one instruction where the machine is little-endian.
std::uint32_t load_u32(const std::byte* p) noexcept {
  return std::to_integer<std::uint32_t>(p[0]) | std::to_integer<std::uint32_t>(p[1]) << 8U |
         std::to_integer<std::uint32_t>(p[2]) << 16U | std::to_integer<std::uint32_t>(p[3]) << 24U;
}

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t previous) noexcept {
  std::uint32_t crc = ~previous;
  const std::byte* p = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 8; p += 8, left -= 8) {
    const std::uint32_t a = crc ^ load_u32(p);
    const std::uint32_t b = load_u32(p + 4);
    crc = kTables[7][a & 0xFFU] ^ kTables[6][a >> 8U & 0xFFU] ^ kTables[5][a >> 16U & 0xFFU] ^ kTables[4][a >> 24U] ^
          kTables[3][b & 0xFFU] ^ kTables[2][b >> 8U & 0xFFU] ^ kTables[1][b >> 16U & 0xFFU] ^ kTables[0][b >> 24U];
  }
  for (; left > 0; ++p, --left) crc = crc >> 8U ^ kTables[0][(crc ^ std::to_integer<std::uint32_t>(*p)) & 0xFFU];
  return ~crc;
}

}  // namespace enamel
