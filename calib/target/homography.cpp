#include "calib/target/homography.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace enamel::calib {
namespace {

/// Moves the points' middle to 0 and their mean distance to sqrt(2).
Eigen::Matrix3d normaliser(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d mean(0, 0);
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  double distance = 0;
  for (const auto& p : points) distance += (p - mean).norm();
  distance /= static_cast<double>(points.size());
  const double s = distance > 0 ? std::sqrt(2.0) / distance : 1.0;
  Eigen::Matrix3d t;
  t << s, 0, -s * mean.x(), 0, s, -s * mean.y(), 0, 0, 1;
  return t;
}

}  // namespace

std::optional<Eigen::Matrix3d> fit_homography(std::span<const Eigen::Vector2d> from,
                                              std::span<const Eigen::Vector2d> to) {
  if (from.size() != to.size() || from.size() < 4) return {};
  const Eigen::Matrix3d tf = normaliser(from);
  const Eigen::Matrix3d tt = normaliser(to);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d p = tf * from[i].homogeneous();
    const Eigen::Vector2d q = map_point(tt, to[i]);
    Eigen::Matrix<double, 2, 9> rows;
    rows << p.transpose(), 0, 0, 0, -q.x() * p.transpose(), 0, 0, 0, p.transpose(), -q.y() * p.transpose();
    normal += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  // Two near-null directions: the points leave the map open.
  if (!(solver.eigenvalues()[1] > 1e-9 * solver.eigenvalues()[8])) return {};
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  Eigen::Matrix3d m;
  m << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  m = tt.inverse() * m * tf;
  if (!(std::abs(m(2, 2)) > 1e-12) || !m.allFinite()) return {};
  return m / m(2, 2);
}

}  // namespace enamel::calib
