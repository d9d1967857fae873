// A desktop mount as it is, errors included: where the table stands before the camera at every stop.
//
//   T_camera_table = Rot(s, p_s; b') Shift(run-out) Rot(r, p_r; a') T_camera_table(0, 0)
//   a' = a + hc_r (cos a - 1) + hs_r sin a,  b' likewise,  a and b the angles of the drives' shafts
//
// Rot(d, p; t) is the right-hand turn by t about the line through p along d; both lines in the camera frame at
// a = b = 0. A commanded angle misses the shaft's by stop error and backlash; an encoder reads the shaft, harmonic
// unseen. Written for the twin alone: nothing here is shared with what calibrates a mount. Pure functions.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "tools/twin/mount/mount_config.hpp"

namespace enamel::twin {

struct Axis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, camera frame
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  std::array<double, 2> harmonic_rad{};  ///< hc, hs
  double backlash_rad = 0;
  Approach approach = Approach::kPositive;
};

struct Mount {
  Axis rotation, swing;
  double wobble_mm = 0;  ///< peak an axis
  std::array<double, 3> wobble_phase_rad{};
  /// Table frame: z along the rotation axis, x towards the swing axis's point, origin the stated point of the axis.
  Eigen::Isometry3d T_camera_table = Eigen::Isometry3d::Identity();  ///< at both angles 0
  Eigen::Isometry3d T_table_model = Eigen::Isometry3d::Identity();
};

/// One stop, radians and mm.
struct StopTruth {
  double rot_cmd = 0, swing_cmd = 0;
  double rot_shaft = 0, swing_shaft = 0;  ///< stop error and backlash in, harmonic out: what an encoder sees
  double rot = 0, swing = 0;              ///< what the table turned by: a', b'
  Eigen::Vector3d run_out_mm = Eigen::Vector3d::Zero();  ///< camera frame at swing 0
};

struct MountRun {
  Mount mount;
  std::vector<StopTruth> stops;
};

/// Bounds of what `draw` adds, uniform within them: tilt of each axis, skew, amplitude of the first harmonic, backlash,
/// wobble.
inline constexpr double kDrawnTilt_deg = 2, kDrawnSkew_mm = 0.3, kDrawnHarmonic_deg = 0.02, kDrawnBacklash_deg = 0.05,
                        kDrawnWobble_um = 3;

/// Unit vector along the axis as the scene states it, tilt included.
[[nodiscard]] Eigen::Vector3d stated_direction(const AxisConfig& axis);

/// What the scene states, with the errors of one unit on top where `draw` asks for them.
[[nodiscard]] MountConfig drawn(const MountConfig& config, std::uint64_t seed);

/// The mount of a scene and all its stops; errors by the seed. Precondition: neither direction is 0, the axes are not
/// parallel.
[[nodiscard]] MountRun drive(const MountConfig& config, std::uint64_t seed);

/// How far beside its target the rotation's (or the swing's) drive stops at its n-th movement, from 0, rms `rms_deg`.
[[nodiscard]] double stop_error_rad(bool is_swing, double rms_deg, std::uint64_t seed, std::uint64_t movement);

/// What the drives' shafts (of rotation and swing, radians) make of the table. The commanded angles are left 0.
[[nodiscard]] StopTruth table_at(const Mount& mount, const std::array<double, 2>& shaft_rad);

/// Right-hand turn about a line.
[[nodiscard]] Eigen::Isometry3d turn_about(const Eigen::Vector3d& direction, const Eigen::Vector3d& point_mm,
                                           double angle_rad);

[[nodiscard]] Eigen::Isometry3d T_camera_table(const Mount& mount, const StopTruth& stop);
[[nodiscard]] Eigen::Isometry3d T_model_camera(const Mount& mount, const StopTruth& stop);

}  // namespace enamel::twin
