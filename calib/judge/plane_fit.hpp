// Plane of least squares through points, by their covariance. Private to calib/judge.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::calib {

struct PlaneFit {
  Vec3d middle = Vec3d::Zero();
  Vec3d normal = Vec3d::UnitZ();  ///< unit, away from the camera
};

/// Of anything that has a `place`, camera coordinates; three at least that are not on one line.
template <class Point>
[[nodiscard]] PlaneFit plane_through(const std::vector<Point>& points) {
  PlaneFit fit;
  for (const Point& p : points) fit.middle += p.place / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Point& p : points) spread += (p.place - fit.middle) * (p.place - fit.middle).transpose();
  fit.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  if (fit.normal.z() < 0) fit.normal = -fit.normal;
  return fit;
}

}  // namespace enamel::calib
