// What is known of single nodes' poses beside all edges, as terms of the pose graph: axes that carried the camera
// there.
#pragma once

#include <Eigen/SparseCore>
#include <cstddef>
#include <vector>

#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

struct PosePrior {
  std::size_t node = 0;
  Pose T_model_node = Pose::Identity();
  Vec3d centre = Vec3d::Zero();               ///< model frame
  Matrix6 information = Matrix6::Identity();  ///< of a motion (rho*omega, tau) about `centre`, mm^-2
};

/// variance: of the edges' residuals in units of their information, which the terms are weighed against. Node 0 is
/// fixed and has no term. Private to pose_graph.
struct PriorSystem {
  std::vector<Eigen::Triplet<double>>& entries;
  Eigen::VectorXd& g;
  const std::vector<Pose>& poses;
  const std::vector<Vec3d>& centres;  ///< that the nodes' motions turn about
};
void add_priors(const std::vector<PosePrior>& priors, PriorSystem system, double rho_mm, double variance);

}  // namespace enamel::pipeline
