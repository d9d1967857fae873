#include "protocol/image/dfu_suffix.hpp"

#include <algorithm>
#include <cstring>

#include "protocol/base/bytes.hpp"
#include "protocol/base/crc32.hpp"

namespace enamel::image {
namespace {

constexpr std::uint16_t kBcdDfu = 0x0100;
constexpr std::uint16_t kBcdDfuSe = 0x011A;
constexpr std::size_t kUncovered = 4;  ///< the CRC itself

/// The suffix alone among this project's checksums leaves out the final inversion: it is taken back.
constexpr std::uint32_t without_inversion(std::uint32_t crc) noexcept { return ~crc; }

}  // namespace

std::array<std::byte, kSuffixSize> make_suffix(std::span<const std::byte> file, const DfuSuffix& suffix) {
  ByteWriter out;
  out.put(suffix.device);
  out.put(suffix.product);
  out.put(suffix.vendor);
  out.put(kBcdDfu);
  out.put_text("UFD");
  out.put(static_cast<std::uint8_t>(kSuffixSize));
  out.put(without_inversion(crc32(out.bytes(), crc32(file))));
  std::array<std::byte, kSuffixSize> bytes{};
  std::copy(out.bytes().begin(), out.bytes().end(), bytes.begin());
  return bytes;
}

Checked<DfuSuffix> read_suffix(std::span<const std::byte> file) noexcept {
  if (file.size() < kSuffixSize) return refuse(Refusal::kTruncated);
  ByteReader in(file.last(kSuffixSize));
  DfuSuffix suffix;
  suffix.device = in.get<std::uint16_t>();
  suffix.product = in.get<std::uint16_t>();
  suffix.vendor = in.get<std::uint16_t>();
  const auto dialect = in.get<std::uint16_t>();
  const bool named = in.take_text(3) == "UFD";
  const auto length = in.get<std::uint8_t>();
  const auto crc = in.get<std::uint32_t>();
  if (!named || length != kSuffixSize) return refuse(Refusal::kTruncated);
  if (crc != without_inversion(crc32(file.first(file.size() - kUncovered)))) return refuse(Refusal::kTruncated);
  if (dialect == kBcdDfuSe) return refuse(Refusal::kDfuSe);
  return suffix;
}

}  // namespace enamel::image
