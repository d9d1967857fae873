// DFU suffix: the 16 bytes at a file's end by which host tools know for whom it is (DFU 1.1, appendix B).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "protocol/image/refusal.hpp"

namespace enamel::image {

inline constexpr std::size_t kSuffixSize = 16;

struct DfuSuffix {
  std::uint16_t device = 0;  ///< bcdDevice, here major << 8 | minor
  std::uint16_t product = kUsbProduct;
  std::uint16_t vendor = kUsbVendor;
};

/// The suffix for a file of these contents.
[[nodiscard]] std::array<std::byte, kSuffixSize> make_suffix(std::span<const std::byte> file, const DfuSuffix& suffix);

/// The suffix of a file that carries one: kTruncated when there is none or its CRC is wrong (the end is missing or the
/// file was altered), kDfuSe for that dialect.
[[nodiscard]] Checked<DfuSuffix> read_suffix(std::span<const std::byte> file) noexcept;

}  // namespace enamel::image
