// Points over the measuring volume as one rig sees them and another triangulates them. Internal to calib/judge.
#pragma once

#include <vector>

#include "calib/solve/observation.hpp"

namespace enamel::calib {

inline constexpr double kHalfFacing_mm = 8;  ///< a facing plane is judged over |x|, |y| up to this

struct VolumePairs {
  std::vector<Vec3d> solved, reference;  ///< same order, mm
};

/// Adds the points of the reference around depth z (its correction moves them off by microns) that the projector
/// reaches, and where the solved rig puts them.
void add_depth(const RigState& solved, const RigState& reference, double z_mm, VolumePairs& pairs);

/// add_depth at nine depths over `range`.
[[nodiscard]] VolumePairs volume_pairs(const RigState& solved, const RigState& reference, DepthRange range);

/// The depths at which planes are judged: 1/8, 1/2 and 7/8 of the range.
[[nodiscard]] std::array<double, 3> plane_depths_mm(DepthRange range);

/// z = x[0] + x[1] X + x[2] Y + x[3] X² + x[4] X Y + x[5] Y², X and Y in units of kHalfFacing_mm.
[[nodiscard]] inline Eigen::Matrix<double, 6, 1> plane_terms(const Vec3d& p) {
  const double x = p.x() / kHalfFacing_mm, y = p.y() / kHalfFacing_mm;
  return (Eigen::Matrix<double, 6, 1>() << 1, x, y, x * x, x * y, y * y).finished();
}

}  // namespace enamel::calib
