// How surely the poses of a solved graph are known: its normal equations, kept as their factor.
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cstddef>
#include <vector>

#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// A point that belongs to a node, in the model's frame, mm.
struct NodePoint {
  std::size_t node = 0;
  Vec3d p_model = Vec3d::Zero();
};

/// Immutable, thread-safe.
class GraphCovariance {
 public:
  /// H: of the motions (rho*omega, tau) of nodes 1 … about their centres, information scaled so that its inverse is
  /// the covariance in mm^2. Node 0 is known.
  GraphCovariance(const Eigen::SparseMatrix<double>& H, std::vector<Vec3d> centres, double rho_mm);

  /// Standard deviation of the distance of two points, mm. 0 for two points of one node.
  [[nodiscard]] double sigma_of_distance_mm(const NodePoint& a, const NodePoint& b) const;

 private:
  [[nodiscard]] Vector6 gradient(const NodePoint& of, const Vec3d& direction) const;

  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  std::vector<Vec3d> centres_;
  double rho_mm_;
};

}  // namespace enamel::pipeline
