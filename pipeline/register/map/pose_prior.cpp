#include "pipeline/register/map/pose_prior.hpp"

#include "pipeline/register/map/graph_terms.hpp"

namespace enamel::pipeline {

void add_priors(const std::vector<PosePrior>& priors, PriorSystem system, double rho_mm, double variance) {
  for (const PosePrior& prior : priors) {
    if (prior.node == 0) continue;
    // The node's own unknowns turn about its centre; the term's motion about the prior's.
    Matrix6 J = Matrix6::Identity();
    J.bottomLeftCorner<3, 3>() = -cross_matrix(prior.centre - system.centres[prior.node]) / rho_mm;
    const Vector6 x = motion_between(prior.T_model_node, system.poses[prior.node], prior.centre, rho_mm);
    const Matrix6 W = variance * prior.information;
    const Matrix6 H = J.transpose() * W * J;
    const auto at = static_cast<Eigen::Index>(6 * (prior.node - 1));
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c) system.entries.emplace_back(at + r, at + c, H(r, c));
    }
    system.g.segment<6>(at) += J.transpose() * W * x;
  }
}

}  // namespace enamel::pipeline
