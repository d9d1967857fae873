// One least-squares adjustment of the mount with its covariance. Private to calib/mount.
#pragma once

#include "calib/mount/axis_start.hpp"
#include "calib/mount/mount_cost.hpp"
#include "calib/mount/mount_solve.hpp"

namespace enamel::calib {

/// Sigmas of what the stops bring of their own.
struct StopPriors {
  std::array<double, 2> angle_rad{};
  double shift_mm = 0;
  double harmonic_rad = 0;
  double dots = 1;  ///< factor of the dots' stated variances
};

struct MountState {
  AxisLine rotation, swing;  ///< backlash as adjusted, of either sign
  Pose T_camera_board = Pose::Identity();
  std::vector<StopBlock> stops;
};

struct Adjusted {
  MountState state;
  /// Of (a, b, c, d) of both lines about `base`, the drives' six, the board's six, then five a stop.
  Eigen::MatrixXd covariance;
  std::array<LineBase, 2> base;  ///< rotation, swing, of the start; a converged start has blocks of zero
  double misfit = 0;
  bool is_determined = false;
  std::vector<StopResult> results;
};

inline constexpr int kMountBlock = 4 + 4 + 6 + 6;  ///< covariance's rows before those of the stops

/// Which stops were reached against the approach, from the order of commands; only axes without a reading have play.
struct LooseStops {
  std::vector<bool> rotation, swing;
  bool is_rotation_seen = false, is_swing_seen = false;  ///< three stops and more from either side
};
[[nodiscard]] LooseStops loose_stops(const std::vector<MountStop>& stops);

/// Place of what the pictures show: mean of the dots, camera frame, over all stops.
[[nodiscard]] Vec3d seen_middle(const std::vector<MountStop>& stops, const TargetDesign& target,
                                const MountState& state);

/// The board's pose of a stop as the state has it.
[[nodiscard]] Pose board_at(const MountState& state, const AxisAngles& angles, const StopBlock& stop);

[[nodiscard]] Adjusted adjust(const std::vector<MountStop>& stops, const TargetDesign& target, const RigState& rig,
                              const StopPriors& priors, const MountState& start);

}  // namespace enamel::calib
