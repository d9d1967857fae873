#include "pipeline/register/map/graph_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace enamel::pipeline {

GraphCovariance::GraphCovariance(const Eigen::SparseMatrix<double>& H, std::vector<Vec3d> centres, double rho_mm)
    : factor_(H), centres_(std::move(centres)), rho_mm_(rho_mm) {}

Vector6 GraphCovariance::gradient(const NodePoint& of, const Vec3d& direction) const {
  // p moves by omega x (p - c) + tau; along a direction u that is ((p - c) x u / rho, u).
  Vector6 out;
  out << (of.p_model - centres_[of.node]).cross(direction) / rho_mm_, direction;
  return out;
}

double GraphCovariance::sigma_of_distance_mm(const NodePoint& a, const NodePoint& b) const {
  const Vec3d apart = a.p_model - b.p_model;
  if (a.node == b.node || apart.norm() <= 0) return 0;
  const Vec3d along = apart.normalized();
  Eigen::VectorXd j = Eigen::VectorXd::Zero(factor_.rows());
  if (a.node > 0) j.segment<6>(static_cast<Eigen::Index>(6 * (a.node - 1))) = gradient(a, along);
  if (b.node > 0) j.segment<6>(static_cast<Eigen::Index>(6 * (b.node - 1))) = -gradient(b, along);
  return std::sqrt(std::max(0.0, j.dot(factor_.solve(j))));
}

}  // namespace enamel::pipeline
