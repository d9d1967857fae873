// Why the middle of a disc's image is not the image of its middle.
#pragma once

#include <Eigen/Core>

#include "calib/model/rig.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::calib {

/// Centre of the ellipse that fits the disc's outline (as fit_disc does, by normal distances) less the image of the
/// disc's centre, px. Perspective alone: f R² sin(tilt) cos(tilt) / Z² (docs/calibration.md §2); distortion adds its
/// second derivative over the disc. `centre_mm` in target coordinates, the disc lies in its plane z = const.
[[nodiscard]] Eigen::Vector2d disc_bias(const LensValues& lens, const Pose& T_cam_target, const Vec3d& centre_mm,
                                        double radius_mm);

}  // namespace enamel::calib
