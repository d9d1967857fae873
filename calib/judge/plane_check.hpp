// A board as a flat: how flat the rig sees the ground between its dots.
#pragma once

#include <string>
#include <vector>

#include "calib/io/calib_folder.hpp"
#include "calib/judge/volume.hpp"
#include "calib/solve/observation.hpp"

namespace enamel::calib {

struct PlaneHeight {
  Eigen::Vector2d camera_px{0, 0};  ///< middle of the 5 x 5 pixels
  double height_um = 0;             ///< over the best plane, positive away from the camera
};

struct PlaneCheck {
  std::string pose;
  std::size_t points = 0;  ///< means over 5 x 5 pixels
  double depth_mm = 0;     ///< of the points' middle
  double rms_um = 0;       ///< distance to the best plane
  double noise_um = 0;     ///< rms that the pixels' own scatter explains
  double p95_um = 0;       ///< 95th percentile of the distances
  PlaneShape shape;        ///< bow and twist over 16 mm in the plane's own axes, positive away from the camera
  PlaneShape sigma;        ///< standard errors of the above, from the scatter of the points
  std::vector<PlaneHeight> heights;
};

/// The ground that was measured with the dots (measure_pose), ripple removed. The board's own shape, where `rig`
/// carries dot offsets, is taken off. Errors: kCalibrationPoses when fewer than 100 points remain.
[[nodiscard]] Result<PlaneCheck> check_plane(const PoseView& view, const TargetDesign& target, const RigState& rig,
                                             const Ripple& ripple);

/// Bow and twist at a depth from planes around it: a straight line over depth through the planes' values, weighted by
/// their standard errors, with a prior of 0.5 um on the slope. No planes: zeros.
struct DepthShape {
  double depth_mm = 0;
  PlaneShape shape, sigma;
};
[[nodiscard]] std::array<DepthShape, 3> shapes_over_depth(const std::vector<PlaneCheck>& planes, DepthRange range);

}  // namespace enamel::calib
