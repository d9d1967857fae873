// Pixels by pitch on the object.
#pragma once

#include <algorithm>
#include <cmath>

namespace enamel::pipeline {

/// Pixels from one that is kept to the next for them to lie about pitch_mm apart; at least 1. px_per_mm: camera pixels
/// a millimetre on a facing surface at mid-depth. Pure.
[[nodiscard]] inline int pixel_step(double pitch_mm, double px_per_mm) {
  return std::max(1, static_cast<int>(std::lround(pitch_mm * px_per_mm)));
}

}  // namespace enamel::pipeline
