// Cheap look at a frame: every 16th row.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/hal/camera.hpp"

namespace enamel::fw {

struct FrameDigest {
  double mean_dn = 0;
  /// Of the rows looked at; none when all their pixels are equal: a blank frame is no evidence of a repeated buffer.
  std::optional<std::uint64_t> hash;
};

[[nodiscard]] constexpr std::size_t bytes_per_pixel(int bit_depth) noexcept { return bit_depth > 8 ? 2 : 1; }
[[nodiscard]] constexpr std::size_t frame_bytes(int width, int height, int bit_depth) noexcept {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * bytes_per_pixel(bit_depth);
}

/// Needs frame.pixels.size() == frame_bytes(…) of its own width, height and depth.
[[nodiscard]] FrameDigest digest(const CameraFrame& frame);

}  // namespace enamel::fw
