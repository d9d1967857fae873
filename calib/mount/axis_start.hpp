// The two axes from poses alone: a start for the joint adjustment, which weighs the pictures themselves.
#pragma once

#include <span>

#include "calib/model/mount.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::calib {

struct AxisStart {
  AxisLine rotation, swing;
  Pose T_camera_board = Pose::Identity();  ///< at both angles 0
};

/// Relative motions D of pairs of stops leave an axis' direction d alone: d is the eigenvector of the smallest
/// eigenvalue of sum w (D - I)'(D - I) with w = sin²(angle/2), so that large angles count; its place solves
/// (I - D) p = t. The swing axis comes from pairs that differ in swing only; the rotation axis from all stops with
/// their swing taken back. Error: kCalibrationPoses where no such pairs exist.
[[nodiscard]] Result<AxisStart> start_axes(std::span<const Pose> T_camera_board, std::span<const AxisAngles> angles);

}  // namespace enamel::calib
