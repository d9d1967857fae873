// Step 3's residual: distance of a reconstructed point from its plane. Private to calib/solve.
#pragma once

#include <Eigen/LU>
#include <array>

#include "calib/solve/observation.hpp"
#include "calib/solve/projection.hpp"

namespace enamel::calib {

/// r = (n . X - d - height) / sigma, X(camera, projector, relative) the point that camera pixel and projector
/// coordinate triangulate to, n and d the pose's target plane. X is defined implicitly, by undistortion and by
/// pi_u(X) = u: Newton steps from the solution at hand give its value and, by the implicit function theorem, its
/// derivatives.
struct PlaneCost {
  static constexpr int kNewtonSteps = 2;  // the second follows the state where it moves away

  Eigen::Vector2d camera_px;
  double projector_u_px = 0, height_mm = 0, weight_per_mm = 0;
  // At the state the cost was made for:
  std::array<double, 2> ray{};
  Eigen::Matrix2d px_to_ray;  ///< d(ray) / d(pixel)
  double z_mm = 0, u_per_mm = 0;

  template <class T>
  bool operator()(const T* camera, const T* projector, const T* relative, const T* motion, T* residual) const {
    std::array<T, 3> p{T(ray[0]), T(ray[1]), T(1.0)};
    T z(z_mm);
    for (int step = 0; step < kNewtonSteps; ++step) {
      const auto c = image(camera, p);
      const std::array<T, 2> off{camera_px.x() - c[0], camera_px.y() - c[1]};
      p[0] += px_to_ray(0, 0) * off[0] + px_to_ray(0, 1) * off[1];
      p[1] += px_to_ray(1, 0) * off[0] + px_to_ray(1, 1) * off[1];
      const auto q = image(projector, move(relative, {p[0] * z, p[1] * z, z}));
      z += (projector_u_px - q[0]) / u_per_mm;
    }
    // The target's z axis, towards the camera, is its plane's normal.
    const std::array<T, 3> unit{T(0.0), T(0.0), T(1.0)};
    std::array<T, 3> normal;
    ceres::AngleAxisRotatePoint(motion, unit.data(), normal.data());
    T distance(-height_mm);
    for (std::size_t i = 0; i < 3; ++i) distance += normal[i] * (p[i] * z - motion[3 + i]);
    residual[0] = weight_per_mm * distance;
    return true;
  }
};

/// The cost of one sample at a state; `variance_factor` multiplies the sample's variance.
[[nodiscard]] PlaneCost plane_cost(const GroundSample& sample, const TargetDesign& target, const RigState& state,
                                   const Pose& T_cam_target, double variance_factor);

/// Depth along `ray` of the target's plane, `height_mm` above it.
[[nodiscard]] double plane_depth_mm(const Pose& T_cam_target, const Vec3d& ray, double height_mm);

/// One sample for each cell of the grid: the mean of what its samples measure beyond the state's prediction, put on the
/// prediction at their middle. What is left of the averaged terms is linear over a cell. Samples beyond five sigma of
/// their cell's scatter are left out.
[[nodiscard]] std::vector<GroundSample> condensed(const std::vector<GroundSample>& ground, const TargetDesign& target,
                                                  const RigState& state, const Pose& T_cam_target);

}  // namespace enamel::calib
