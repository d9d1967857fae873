// Pixels on loan: from a camera's DMA buffers, which the sensor needs back, or from the heap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace enamel::fw {

/// How a row lies in memory.
enum class PixelFormat : std::uint8_t {
  kRaw8,         ///< one byte a pixel
  kRaw16,        ///< two bytes a pixel, little endian, value in the low bits (R10 of libcamera and V4L2)
  kRaw10Packed,  ///< four pixels in five bytes: their high eight bits, then the low two of each (MIPI CSI-2, R10_CSI2P)
};

/// Bytes of a row without padding.
[[nodiscard]] constexpr std::size_t row_bytes(PixelFormat format, int width) noexcept {
  const auto w = static_cast<std::size_t>(width);
  switch (format) {
    case PixelFormat::kRaw16:
      return 2 * w;
    case PixelFormat::kRaw10Packed:
      return (w * 10 + 7) / 8;
    case PixelFormat::kRaw8:
      break;
  }
  return w;
}

/// Frames from the heap: one byte a pixel up to 8 bit, two above.
[[nodiscard]] constexpr PixelFormat unpacked_format(int bit_depth) noexcept {
  return bit_depth > 8 ? PixelFormat::kRaw16 : PixelFormat::kRaw8;
}

/// Shared, read-only. The memory goes back to its lender when the last copy is gone, on that copy's thread. DMA memory
/// is slow to read: read each byte once, in order, and let go.
class PixelLoan {
 public:
  PixelLoan() = default;
  /// From the heap; rows of `stride` bytes, or 0: without padding.
  explicit PixelLoan(std::vector<std::uint8_t> bytes, std::size_t stride = 0) : stride_(stride) {
    auto kept = std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes));
    bytes_ = *kept;
    owner_ = std::move(kept);
  }
  PixelLoan(std::span<const std::uint8_t> bytes, std::size_t stride, std::shared_ptr<const void> owner)
      : bytes_(bytes), stride_(stride), owner_(std::move(owner)) {}

  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept { return bytes_; }
  /// The whole frame is there: `height` rows of `row` bytes.
  [[nodiscard]] bool holds(std::size_t row, int height) const noexcept {
    if (height < 1 || row < 1 || step(row) < row) return false;
    return (static_cast<std::size_t>(height) - 1) * step(row) + row <= bytes_.size();
  }
  /// Needs holds(row, y + 1).
  [[nodiscard]] std::span<const std::uint8_t> row(std::size_t row, int y) const noexcept {
    return bytes_.subspan(static_cast<std::size_t>(y) * step(row), row);
  }
  void give_back() noexcept { *this = PixelLoan(); }

 private:
  [[nodiscard]] std::size_t step(std::size_t row) const noexcept { return stride_ == 0 ? row : stride_; }

  std::span<const std::uint8_t> bytes_;
  std::size_t stride_ = 0;
  std::shared_ptr<const void> owner_;
};

}  // namespace enamel::fw
