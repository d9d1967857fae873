// What a calibrated mount knows of a stop's pose: where the axes say the camera is, and how surely.
#pragma once

#include "calib/model/mount.hpp"
#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/register/map/pose_prior.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// What a stop adds of its own to what its mount says: one sigma each.
struct StopSigma {
  double angle_rad = 5.236e-4;  ///< chosen: of either axis, 0.03 degrees, as MountOptions of the calibration
  double shift_mm = 0.003;      ///< chosen: run-out of the table, every direction
  double turn_rad = 2e-5;       ///< chosen: tilt that goes with the run-out: 3 um over a bearing of 150 mm
};

/// The model's frame is the camera's with both axes at zero: T_model_cam = (Rot(swing; b') Rot(rotation; a'))^-1.
[[nodiscard]] Pose pose_by_axes(const calib::Mount& mount, const calib::AxisAngles& angles);

/// What the axes' word is mended by once they, the model or the table have moved by themselves.
struct AxesOffset {
  double rotation_rad = 0, swing_rad = 0;
  Pose on_table = Pose::Identity();       ///< of the model
  Pose before_camera = Pose::Identity();  ///< of the camera
  [[nodiscard]] bool is_of_angles_only() const {
    return on_table.isApprox(Pose::Identity(), 0) && before_camera.isApprox(Pose::Identity(), 0);
  }
};
[[nodiscard]] calib::AxisAngles turned_by(const calib::AxisAngles& angles, const AxesOffset& by);
/// T_model_cam = on_table * pose_by_axes(angles, turned) * before_camera.
[[nodiscard]] Pose pose_by_axes(const calib::Mount& mount, const calib::AxisAngles& angles, const AxesOffset& by);

/// The motions (rho*omega, tau) about `centre` (model frame) that a radian more of either axis makes of the camera's
/// pose there.
struct AxisMotions {
  Vector6 rotation, swing;
};
[[nodiscard]] AxisMotions axis_motions(const calib::Mount& mount, const calib::AxisAngles& angles, const Vec3d& centre,
                                       double rho_mm);
/// The same where the axes' word is mended: a model that has moved on the table sees the axes elsewhere.
[[nodiscard]] AxisMotions axis_motions(const calib::Mount& mount, const calib::AxisAngles& angles, const AxesOffset& by,
                                       const Vec3d& centre, double rho_mm);

/// Of a pose about `centre`, mm^2.
[[nodiscard]] Matrix6 pose_covariance(const AxisMotions& motions, const StopSigma& sigma, double rho_mm);

/// A deviation of a stop's pose, taken apart: angles that the axes most likely stood beyond what was read, and what no
/// angle explains, at the centre.
struct StopDeviation {
  double rotation_rad = 0, swing_rad = 0;
  double rest_mm = 0;  ///< shift that is left, turns by their lever
};
/// `x`: as motion_between(pose_by_axes, pose, centre, rho). By least squares, nothing assumed of the angles.
[[nodiscard]] StopDeviation take_apart(const Vector6& x, const AxisMotions& motions);

}  // namespace enamel::pipeline
