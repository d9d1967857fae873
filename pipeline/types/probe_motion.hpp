// What a burst's own frames and times say about the probe's motion while it was exposed.
#pragma once

#include <optional>

#include "pipeline/types/geometry.hpp"

namespace enamel {

/// Velocity of the camera against the surface, in the camera's axes at mid-burst: a shift of the point (0, 0, about_mm)
/// and a turn about it.
struct ProbeTwist {
  Vec3d shift_mm_s = Vec3d::Zero();
  Vec3d turn_rad_s = Vec3d::Zero();
  double about_mm = 0;
};

struct BurstMotion {
  std::optional<ProbeTwist> twist;  ///< where the burst shows it
  double exposure_spread_s2 = 0;    ///< mean square of (instant of exposure - mid-burst); 0 = unknown
};

}  // namespace enamel
