// Pixels from the camera's memory into the form in which they travel.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware/acquire/assembler.hpp"
#include "firmware/hal/camera.hpp"

namespace enamel::fw {

[[nodiscard]] constexpr std::size_t bytes_per_pixel(int bit_depth) noexcept { return bit_depth > 8 ? 2 : 1; }
/// Of a frame as it travels: one byte a pixel up to 8 bit, two above, little endian, rows without padding.
[[nodiscard]] constexpr std::size_t frame_bytes(int width, int height, int bit_depth) noexcept {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * bytes_per_pixel(bit_depth);
}

/// All rows are there, in a format that fits the depth.
[[nodiscard]] bool is_whole(const CameraFrame& frame) noexcept;
/// Needs is_whole(frame); `out`: a row as it travels.
void unpack_row(const CameraFrame& frame, int y, std::span<std::uint8_t> out) noexcept;

struct FrameLevels {
  double mean_dn = 0;
  std::uint64_t saturated = 0;
  std::uint64_t count = 0;
};

/// Four frames one behind the other.
struct BurstPixels {
  std::vector<std::uint8_t> bytes;
  std::array<FrameLevels, 4> levels;
};

/// The one copy on a burst's way out: each byte of the frames is read once and in order, then their memory goes back to
/// the camera. Empty where a frame is not whole or not of the first one's size.
[[nodiscard]] BurstPixels take_pixels(AssembledBurst& burst);

}  // namespace enamel::fw
