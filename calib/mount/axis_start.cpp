#include "calib/mount/axis_start.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <optional>

namespace enamel::calib {
namespace {

constexpr double kSame = 0.5 * kRadPerDegree;    // of the other axis
constexpr double kMinAngle = 2 * kRadPerDegree;  // of a relative motion that says where its axis is

double wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

/// Sums over relative motions about one axis.
class AxisSums {
 public:
  void add(const Pose& motion, double angle) {
    const Eigen::Matrix3d moved = motion.linear() - Eigen::Matrix3d::Identity();
    const double weight = std::pow(std::sin(0.5 * angle), 2);
    directions_ += weight * moved.transpose() * moved;
    places_ -= weight * moved.transpose() * motion.translation();
    const Eigen::Matrix3d r = motion.linear();
    sense_ += std::sin(angle) * Vec3d(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
    ++pairs_;
  }

  [[nodiscard]] std::optional<AxisLine> line() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(directions_);
    const Vec3d& values = solver.eigenvalues();
    if (pairs_ < 2 || !(values[1] > 1e-12) || !(values[0] < 0.2 * values[1])) return {};
    Vec3d direction = solver.eigenvectors().col(0);
    if (direction.dot(sense_) < 0) direction = -direction;
    Vec3d point = Vec3d::Zero();
    for (int k = 1; k < 3; ++k) {
      const Vec3d e = solver.eigenvectors().col(k);
      point += e * (e.dot(places_) / values[k]);
    }
    AxisLine line;
    line.direction = {direction.x(), direction.y(), direction.z()};
    line.point_mm = {point.x(), point.y(), point.z()};
    return line;
  }

 private:
  Eigen::Matrix3d directions_ = Eigen::Matrix3d::Zero();
  Vec3d places_ = Vec3d::Zero(), sense_ = Vec3d::Zero();
  int pairs_ = 0;
};

Pose turn_about(const AxisLine& line, double angle) {
  const Vec3d d(line.direction.data());
  const Vec3d p(line.point_mm.data());
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, d).toRotationMatrix();
  pose.translation() = p - pose.linear() * p;
  return pose;
}

}  // namespace

Result<AxisStart> start_axes(std::span<const Pose> T_camera_board, std::span<const AxisAngles> angles) {
  const std::size_t n = std::min(T_camera_board.size(), angles.size());
  AxisSums swing, rotation;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double by = angles[i].swing() - angles[j].swing();
      if (std::abs(wrapped(angles[i].rotation() - angles[j].rotation())) > kSame || std::abs(by) < kMinAngle) continue;
      swing.add(T_camera_board[i] * T_camera_board[j].inverse(), by);
    }
  }
  const auto swing_line = swing.line();
  if (!swing_line) {
    return fail(ErrorCode::kCalibrationPoses,
                "the axes cannot be told apart: take stops that differ in swing alone, at one angle of the table");
  }
  std::vector<Pose> level;
  for (std::size_t i = 0; i < n; ++i) level.push_back(turn_about(*swing_line, -angles[i].swing()) * T_camera_board[i]);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double by = wrapped(angles[i].rotation() - angles[j].rotation());
      if (std::abs(by) >= kMinAngle) rotation.add(level[i] * level[j].inverse(), by);
    }
  }
  const auto rotation_line = rotation.line();
  if (!rotation_line) {
    return fail(ErrorCode::kCalibrationPoses,
                "the stops leave the rotation axis open: turn the table over more of its circle");
  }
  // Any stop starts the board's pose; the one nearest to both zeros is least moved by what is not known yet.
  std::size_t first = 0;
  const auto away = [&](std::size_t i) {
    return std::abs(wrapped(angles[i].rotation())) + std::abs(angles[i].swing());
  };
  for (std::size_t i = 1; i < n; ++i)
    if (away(i) < away(first)) first = i;
  return AxisStart{*rotation_line, *swing_line, turn_about(*rotation_line, -angles[first].rotation()) * level[first]};
}

}  // namespace enamel::calib
