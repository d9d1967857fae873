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

/// Needs is_whole(frame).
[[nodiscard]] FrameDigest digest(const CameraFrame& frame);

}  // namespace enamel::fw
