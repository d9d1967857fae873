// Scene files have degrees and micrometres where that is what one says, code has radians and millimetres.
#pragma once

#include <numbers>

namespace enamel::twin {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr double kMmPerUm = 1e-3;

}  // namespace enamel::twin
