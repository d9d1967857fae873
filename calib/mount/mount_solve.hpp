// From dots in pictures to the two axes: joint adjustment of both lines, the board's place, the drives' harmonics and a
// correction of every stop. Derivation: docs/desktop-calibration.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "calib/mount/stops.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::calib {

struct MountOptions {
  double stop_prior_rad = 0.0005236;    ///< sigma of a stop's angle beyond the model, 0.03 degrees; the most it may be
  double harmonic_prior_rad = 0.00175;  ///< 0.1 degrees
  double wobble_prior_mm = 0.003;       ///< sigma of the table's run-out a stop, to start with
  double gross = 4;                     ///< a correction beyond so many priors is a wrong stop
  double max_gross_share = 0.15;        ///< of the stops: more wrong ones are a slipping table
  Eigen::MatrixXd rig_covariance = {};  ///< of rig_parameter_names(); empty: the rig is taken for perfect
};

/// A stop in the solution.
struct StopResult {
  std::string pose;
  double rotation_rad = 0, swing_rad = 0;  ///< corrections
  Vec3d shift_mm{0, 0, 0};                 ///< of the table, camera frame
  std::size_t dots = 0;
  double rms_camera_px = 0, rms_projector_px = 0;
};

struct StopNote {
  std::string pose, reason;
};

/// Standard deviations of a line: direction (the larger of both ways) and place, at the point of the line nearest to
/// what was seen.
struct LineSigma {
  double direction_rad = 0, place_mm = 0;
};

struct MountSolution {
  Mount mount;                             ///< serial and calibrated_at are the caller's
  Pose T_camera_board = Pose::Identity();  ///< at both angles 0
  std::vector<StopResult> stops;
  std::vector<StopNote> left_out;
  LineSigma rotation, swing;                                       ///< with what the rig's own uncertainty adds
  LineSigma rotation_by_pictures, swing_by_pictures;               ///< without it
  bool has_rig_share = false;                                      ///< MountOptions::rig_covariance was there
  double misfit = 0;                                               ///< chi² of the dots over their redundancy
  std::array<double, 2> stop_sigma_rad{};                          ///< of the corrections, estimated
  double wobble_sigma_mm = 0;                                      ///< of the shifts, estimated
  bool is_rotation_play_seen = false, is_swing_play_seen = false;  ///< stops were reached from both sides
};

/// `rig`: camera, projector and T_proj_cam of the solved rig. Dots' centres are freed of perspective's bias on the way.
/// Deterministic: one thread, fixed order. Errors: kCalibrationPoses (too few stops, too small a span, axes that cannot
/// be told apart), kCalibrationRefused (a table that slips).
[[nodiscard]] Result<MountSolution> solve_mount(std::vector<MountStop> stops, const TargetDesign& target,
                                                const RigState& rig, const MountOptions& options = {});

}  // namespace enamel::calib
