#include "viewer/scene/follow_camera.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace enamel::view {
namespace {

/// Camera axes (x right, y down, z forward) as view axes (x right, y up, z back).
Eigen::Matrix3d view_axes(const Eigen::Matrix3d& R_model_cam) {
  Eigen::Matrix3d axes = R_model_cam;
  axes.col(1) = -axes.col(1);
  axes.col(2) = -axes.col(2);
  return axes;
}

struct Shape {
  Vec3d centre = Vec3d::Zero();
  Vec3d normal = Vec3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::size_t vertices = 0;
};

Shape shape_of(const ModelSnapshot& model) {
  Shape shape;
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const auto& block : model.blocks) {
    if (!block) {
      continue;
    }
    for (const Vec3f& vertex : block->vertices) {
      const Vec3d p = vertex.cast<double>();
      shape.centre += p;
      squares += p * p.transpose();
      ++shape.vertices;
    }
    for (const Vec3f& normal : block->normals) {
      shape.normal += normal.cast<double>();
    }
  }
  if (shape.vertices > 0) {
    const double n = static_cast<double>(shape.vertices);
    shape.centre /= n;
    shape.covariance = squares / n - shape.centre * shape.centre.transpose();
  }
  return shape;
}

/// Longest direction of the model across `back`, turned so that up points against the first camera's y (down) axis.
Eigen::Matrix3d level_axes(const Shape& shape, const Vec3d& back) {
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - back * back.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(across * shape.covariance * across);
  Vec3d right = across * solver.eigenvectors().col(2);
  if (!(right.norm() > 1e-6)) {
    right = back.unitOrthogonal();
  }
  right.normalize();
  Vec3d up = back.cross(right);
  if (up.y() > 0 || (up.y() == 0 && right.x() < 0)) {
    right = -right;
    up = -up;
  }
  Eigen::Matrix3d axes;
  axes << right, up, back;
  return axes;
}

}  // namespace

ViewCamera follow_goal(const Pose& T_model_cam, double surface_distance_mm, const ProbeField& field,
                       const FollowConfig& config) {
  const double middle_mm = 0.5 * (field.near_mm + field.far_mm);
  const double depth_mm = std::isfinite(surface_distance_mm) ? surface_distance_mm : middle_mm;
  ViewCamera camera;
  camera.target = T_model_cam * Vec3d(0, 0, depth_mm);
  const Eigen::Quaterniond behind(view_axes(T_model_cam.linear()));
  const Eigen::Quaterniond lean =
      Eigen::AngleAxisd(config.turn_rad, Vec3d::UnitY()) * Eigen::AngleAxisd(config.tilt_rad, Vec3d::UnitX());
  camera.R_model_view = (behind * lean).normalized();
  camera.distance_mm = 0.5 * config.height_mm / std::tan(0.5 * camera.fov_y_rad);
  pan(camera, config.shift_right, 0);
  return camera;
}

ViewCamera FollowCamera::step(const ViewCamera& now, const ViewCamera& goal, double dt_s) {
  if (jump_) {
    jump_ = false;
    moving_ = false;
    return goal;
  }
  const double off_mm =
      std::max((goal.target - now.target).norm(), 0.25 * std::abs(goal.distance_mm - now.distance_mm));
  const double off_rad = now.R_model_view.angularDistance(goal.R_model_view);
  if (moving_) {
    moving_ = off_mm > config_.stop_mm || off_rad > config_.stop_rad;
  } else {
    moving_ = off_mm > config_.start_mm || off_rad > config_.start_rad;
  }
  if (!moving_ || !(dt_s > 0)) {
    return now;
  }
  const double share = 1 - std::exp(-dt_s / config_.time_constant_s);
  double turn = share;
  if (off_rad > 0) {
    turn = std::min(turn, config_.max_turn_rad_per_s * dt_s / off_rad);
  }
  ViewCamera next = now;
  next.target += share * (goal.target - now.target);
  next.distance_mm += share * (goal.distance_mm - now.distance_mm);
  next.fov_y_rad = goal.fov_y_rad;
  next.R_model_view = now.R_model_view.slerp(turn, goal.R_model_view).normalized();
  return next;
}

std::optional<ViewCamera> overview(const ModelSnapshot& model, double aspect, double fill) {
  constexpr double kLeanRad = 0.5;
  const Shape shape = shape_of(model);
  if (shape.vertices == 0) {
    return std::nullopt;
  }
  const Vec3d back = shape.normal.norm() > 1e-9 ? Vec3d(shape.normal.normalized()) : Vec3d(-Vec3d::UnitZ());
  ViewCamera camera;
  camera.R_model_view = Eigen::Quaterniond(level_axes(shape, back)) * Eigen::AngleAxisd(kLeanRad, Vec3d::UnitX());
  const Eigen::Matrix3d to_view = camera.R_model_view.conjugate().toRotationMatrix();
  Eigen::AlignedBox3d box;
  for (const auto& block : model.blocks) {
    if (block) {
      for (const Vec3f& vertex : block->vertices) {
        box.extend(Vec3d(to_view * vertex.cast<double>()));
      }
    }
  }
  camera.target = camera.R_model_view * box.center();
  const Vec3d size = box.sizes();
  const double height_mm = std::max({size.y(), size.x() / std::max(aspect, 1e-3), 8.0}) / std::clamp(fill, 0.1, 1.0);
  camera.distance_mm =
      std::clamp(0.5 * height_mm / std::tan(0.5 * camera.fov_y_rad) + 0.5 * size.z(), kMinDistanceMm, kMaxDistanceMm);
  pan(camera, 0.01, -0.04);  // the live image fills the lower left corner
  return camera;
}

}  // namespace enamel::view
