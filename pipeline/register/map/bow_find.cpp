#include "pipeline/register/map/bow_find.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::pipeline {
namespace {

/// About the viewing axis, 0 … 90: half a turn shows a bow the same as none.
double rolled_deg(const Pose& T_j_i) {
  const Eigen::Matrix3d R = T_j_i.linear();
  const double roll = std::abs(std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1))) * 180 / std::numbers::pi;
  return std::min(roll, 180 - roll);
}

BowMatrix prior_of(double sigma_mm) { return BowMatrix::Identity() * sigma_mm * sigma_mm; }

}  // namespace

BowFacts judge_bow(const BowEstimate& estimate, const BowConfig& config) {
  BowFacts out;
  out.bow = estimate.bow;
  out.sigma = estimate.covariance.diagonal().cwiseMax(0).cwiseSqrt();
  // In units of the prior the posterior's axes are apart from each other: along each the scan tells something or not.
  const Eigen::LLT<BowMatrix> prior(estimate.prior);
  const BowMatrix half = prior.matrixL().solve(estimate.covariance);
  const BowMatrix posterior = prior.matrixL().solve(half.transpose());
  const BowVector bow = prior.matrixL().solve(estimate.bow);
  const Eigen::SelfAdjointEigenSolver<BowMatrix> eigen(posterior);
  BowVector along = BowVector::Zero();
  for (int k = 0; k < kBowTerms; ++k) {
    const double sigma = std::sqrt(std::max(eigen.eigenvalues()[k], 0.0));
    if (sigma > config.determined) continue;
    const BowVector v = eigen.eigenvectors().col(k);
    ++out.determined;
    along += v * v.dot(bow);
    out.applied = out.applied || std::abs(v.dot(bow)) > config.sigmas * sigma;
  }
  if (out.applied) out.taken_out = prior.matrixL() * along;
  return out;
}

BowFacts find_bow(const SolvedGraph& solved, const std::vector<MapEdge>& edges, const std::vector<EdgeBow>& bows,
                  const GraphConfig& graph, const BowConfig& config) {
  const SolvedGraph bent = solve_graph(solved.poses, edges, graph, {}, {}, {bows, prior_of(config.prior_mm)});
  if (!bent.bow) return {};
  BowFacts out = judge_bow(*bent.bow, config);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (bent.switches[e] >= 0.5) out.rolled_deg = std::max(out.rolled_deg, rolled_deg(edges[e].T_j_i));
  }
  return out;
}

void take_out(const BowVector& bow, double rho_mm, std::vector<MapEdge>& edges, std::vector<EdgeBow>& bows) {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    MapEdge& edge = edges[e];
    edge.T_j_i = apply_motion(bows[e].motion * bow, edge.centre, rho_mm, edge.T_j_i);
    bows[e].g -= bows[e].H * bow;
  }
}

std::shared_ptr<const GraphCovariance> covariance_with_bow(const SolvedGraph& solved, const std::vector<MapEdge>& edges,
                                                           const std::vector<EdgeBow>& bows, GraphConfig graph,
                                                           double sigma_mm) {
  graph.rounds = 1;
  return solve_graph(solved.poses, edges, graph, {}, {}, {bows, prior_of(sigma_mm)}).covariance;
}

}  // namespace enamel::pipeline
