// First values of a lens and its target poses, by two ways: Zhang's homographies and Tsai's radial alignment
// constraint.
#pragma once

#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/types/geometry.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

/// Points of one pose: places on the target (mm, z = 0) and their images (px).
struct PlaneView {
  std::string name;
  std::vector<Eigen::Vector2d> target_mm;
  std::vector<Eigen::Vector2d> image_px;
};

struct LensStart {
  std::string method;  ///< "Zhang" or "RAC"
  LensValues lens;
  std::vector<Pose> T_lens_target;
  double rms_px = 0;                        ///< sqrt(mean(dx² + dy²)) after stepwise refinement
  std::vector<std::string> singular_poses;  ///< tilted too little to tell focal length from distance (RAC)
};

/// Zhang 2000: closed form from the homographies, then stepwise refinement. `design` gives size and, as k3, what is not
/// solved. Error: kCalibrationPoses.
[[nodiscard]] Result<LensStart> zhang_start(const std::vector<PlaneView>& views, const LensValues& design);

/// Tsai 1987, coplanar points: with the design's principal point, rotation and lateral shift of each pose linearly,
/// then focal length and distance, then stepwise refinement. Error: kCalibrationPoses when every pose is singular.
[[nodiscard]] Result<LensStart> rac_start(const std::vector<PlaneView>& views, const LensValues& design);

/// Poses from homographies for a known lens. Error: kCalibrationPoses.
[[nodiscard]] Result<std::vector<Pose>> poses_for_lens(const std::vector<PlaneView>& views, const LensValues& lens);

/// The better of the two, by rms_px. Error: kCalibrationPoses when neither works, with both reasons.
[[nodiscard]] Result<LensStart> best_start(const std::vector<PlaneView>& views, const LensValues& design);

}  // namespace enamel::calib
