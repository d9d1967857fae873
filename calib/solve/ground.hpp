// The ground between the dots: a dense sample of the board's surface that no dot's edge disturbs.
#pragma once

#include "calib/fringe/phase.hpp"
#include "calib/solve/observation.hpp"

namespace enamel::calib {

/// Means over 5 x 5 pixels, every pixel with a coordinate, the middle at least `clearance_mm` from any dot's edge and
/// inside the outermost dots. `period_px`: of the finest fringes along u. Their variances are those of `u` times what
/// the scatter inside the blocks says of them, one factor a pose, so that images noisier than stated are taken as such.
[[nodiscard]] std::vector<GroundSample> ground_samples(const CoordinateMap& u, const PoseView& dots,
                                                       const TargetDesign& target, double period_px,
                                                       double clearance_mm = 0.5);

/// Takes the ripple off `ground`; what is free of it already stays as it is.
void remove_ripple(const Ripple& ripple, std::vector<GroundSample>& ground);

/// Height of the real board towards the camera at a place between four dots whose offsets are known, mm; 0 for a
/// perfect one (`offsets` empty).
[[nodiscard]] double board_height_mm(const TargetDesign& target, const Eigen::Vector2d& cell,
                                     const std::vector<Vec3d>& offsets);

}  // namespace enamel::calib
