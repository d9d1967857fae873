// Angles in scene files are in degrees, in code in radians.
#pragma once

#include <numbers>

namespace enamel::twin {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;

}  // namespace enamel::twin
