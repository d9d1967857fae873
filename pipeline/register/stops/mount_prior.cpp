#include "pipeline/register/stops/mount_prior.hpp"

#include <Eigen/Dense>

#include "pipeline/types/pose_rows.hpp"

namespace enamel::pipeline {
namespace {

/// Right-hand turn by a radian about a line.
Vector6 turn_about(const Vec3d& direction, const Vec3d& point, const Vec3d& centre, double rho_mm) {
  Vector6 x;
  x.head<3>() = rho_mm * direction;
  x.tail<3>() = direction.cross(centre - point);
  return x;
}

}  // namespace

Pose pose_by_axes(const calib::Mount& mount, const calib::AxisAngles& angles) {
  return pose_of_rows(calib::table_motion(mount, angles)).inverse();
}

calib::AxisAngles turned_by(const calib::AxisAngles& angles, const AxesOffset& by) {
  return {angles.rotation() + by.rotation_rad, angles.swing() + by.swing_rad};
}

Pose pose_by_axes(const calib::Mount& mount, const calib::AxisAngles& angles, const AxesOffset& by) {
  return by.on_table * pose_by_axes(mount, turned_by(angles, by)) * by.before_camera;
}

AxisMotions axis_motions(const calib::Mount& mount, const calib::AxisAngles& angles, const Vec3d& centre,
                         double rho_mm) {
  // T_model_cam = Rot(r; -a') Rot(s; -b'): more of a' turns the model's side, about r as it stands in the model's
  // frame; more of b' turns about the swing axis as the table carries it into that frame.
  const Vec3d r(mount.rotation.direction.data()), p_r(mount.rotation.point_mm.data());
  const Vec3d s(mount.swing.direction.data()), p_s(mount.swing.point_mm.data());
  calib::AxisAngles turned = angles;
  turned.swing_command = turned.swing_read = 0;
  const Pose T_model_cradle = pose_of_rows(calib::table_motion(mount, turned)).inverse();
  return {-turn_about(r, p_r, centre, rho_mm),
          -turn_about(T_model_cradle.linear() * s, T_model_cradle * p_s, centre, rho_mm)};
}

AxisMotions axis_motions(const calib::Mount& mount, const calib::AxisAngles& angles, const AxesOffset& by,
                         const Vec3d& centre, double rho_mm) {
  const AxisMotions there = axis_motions(mount, turned_by(angles, by), by.on_table.inverse() * centre, rho_mm);
  const auto carried = [&](const Vector6& x) {
    Vector6 out;
    out << by.on_table.linear() * x.head<3>(), by.on_table.linear() * x.tail<3>();
    return out;
  };
  return {carried(there.rotation), carried(there.swing)};
}

Matrix6 pose_covariance(const AxisMotions& motions, const StopSigma& sigma, double rho_mm) {
  Matrix6 out = Matrix6::Zero();
  out.diagonal().head<3>().setConstant(sigma.turn_rad * sigma.turn_rad * rho_mm * rho_mm);
  out.diagonal().tail<3>().setConstant(sigma.shift_mm * sigma.shift_mm);
  const double angle2 = sigma.angle_rad * sigma.angle_rad;
  out += angle2 * (motions.rotation * motions.rotation.transpose() + motions.swing * motions.swing.transpose());
  return out;
}

StopDeviation take_apart(const Vector6& x, const AxisMotions& motions) {
  Eigen::Matrix<double, 6, 2> J;
  J << motions.rotation, motions.swing;
  const Eigen::Vector2d angles = J.colPivHouseholderQr().solve(x);
  return {angles[0], angles[1], (x - J * angles).norm()};
}

}  // namespace enamel::pipeline
