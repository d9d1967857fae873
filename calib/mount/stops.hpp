// What the mount's calibration starts from: pictures of a board that lies on the table, each at a stop of both axes.
#pragma once

#include <string>
#include <vector>

#include "calib/io/calib_folder.hpp"
#include "calib/model/mount.hpp"
#include "calib/solve/observation.hpp"

namespace enamel::calib {

/// A picture's dots and the angles at which it was taken. `view.name`: the pose's.
struct MountStop {
  PoseView view;
  AxisAngles angles;
};

/// The table axes.csv of a calibration folder (docs/desktop-calibration.md): angles of every pose of `poses`, in their
/// order. A pose's key is its folder's name or the same number without leading zeros. Errors: kAxesMissing for no such
/// table or a pose without a row; kFileRead; those of parse_axes_table; kCalibrationFolder for a row without a pose, or
/// two rows for one pose.
[[nodiscard]] Result<std::vector<AxisAngles>> read_pose_axes(const std::string& folder,
                                                             const std::vector<std::string>& poses);

/// The board's pose by the camera's picture of its dots: homography's start (IPPE, Collins and Bartoli 2014), then
/// least squares. Needs four dots. Error: kCalibrationPoses.
[[nodiscard]] Result<Pose> board_pose(const PoseView& view, const TargetDesign& target, const LensValues& camera);

}  // namespace enamel::calib
