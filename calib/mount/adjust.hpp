// One least-squares adjustment of the mount with its covariance. Private to calib/mount.
#pragma once

#include "calib/mount/axis_start.hpp"
#include "calib/mount/mount_problem.hpp"
#include "calib/mount/mount_solve.hpp"

namespace enamel::calib {

struct MountState {
  AxisLine rotation, swing;  ///< backlash as adjusted, of either sign
  Pose T_camera_board = Pose::Identity();
  std::vector<StopBlock> stops;
};

struct Adjusted {
  MountState state;
  /// Of (a, b, c, d) of both lines about `base`, the drives' six, the board's six, then five a stop.
  Eigen::MatrixXd covariance;
  MountBlocks blocks;
  std::array<LineBase, 2> base;  ///< rotation, swing, of the start; a converged start has blocks of zero
  double misfit = 0;
  bool is_determined = false;
  std::vector<StopResult> results;
};

inline constexpr int kMountBlock = 4 + 4 + 6 + 6;  ///< covariance's rows before those of the stops

/// Place of what the pictures show: mean of the dots, camera frame, over all stops.
[[nodiscard]] Vec3d seen_middle(const std::vector<MountStop>& stops, const TargetDesign& target,
                                const MountState& state);

/// The board's pose of a stop as the state has it.
[[nodiscard]] Pose board_at(const MountState& state, const AxisAngles& angles, const StopBlock& stop);

[[nodiscard]] Adjusted adjust(const std::vector<MountStop>& stops, const TargetDesign& target, const RigState& rig,
                              const StopPriors& priors, const MountState& start);

/// What the rig's own uncertainty adds to the covariance: with x* where the gradient vanishes, dx*/dp = -N^-1 J_x^T
/// J_p, and C_p of the rig's parameters p goes along with it. The dots' centres are held: what p changes of their bias
/// is of second order.
[[nodiscard]] Eigen::MatrixXd rig_share(const std::vector<MountStop>& stops, const TargetDesign& target,
                                        const RigState& rig, const StopPriors& priors, const Adjusted& adjusted,
                                        const Eigen::MatrixXd& rig_covariance);

}  // namespace enamel::calib
