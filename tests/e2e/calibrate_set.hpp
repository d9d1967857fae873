// A calibration folder of the tests' own making, as `enamel calibrate` reads it.
#pragma once

#include <string>

namespace enamel {

inline constexpr int kPoses = 5;

/// Poses, the probe's nominal rig and the target.
void write_set(const std::string& folder);

}  // namespace enamel
