#include "pipeline/register/map/bow_factors.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "pipeline/register/map/graph_terms.hpp"

namespace enamel::pipeline {
namespace {

template <class Block>
void add_block(std::vector<Eigen::Triplet<double>>& entries, Eigen::Index row, Eigen::Index column,
               const Block& block) {
  for (Eigen::Index r = 0; r < block.rows(); ++r) {
    for (Eigen::Index c = 0; c < block.cols(); ++c) entries.emplace_back(row + r, column + c, block(r, c));
  }
}

/// How badly `bow` fits what lies between two surfaces, over the degrees of freedom.
double misfit(const EdgeBow& edge, const BowVector& bow) {
  const BowVector off = edge.H * bow - edge.g;
  const Eigen::SelfAdjointEigenSolver<BowMatrix> eigen(edge.H);
  // A direction that the pair says nothing of must not be judged by rounding.
  const double least = 1e-9 * eigen.eigenvalues()[kBowTerms - 1];
  double chi2 = 0;
  for (int k = 0; k < kBowTerms; ++k) {
    const double along = eigen.eigenvectors().col(k).dot(off);
    if (eigen.eigenvalues()[k] > least) chi2 += along * along / eigen.eigenvalues()[k];
  }
  return chi2 / kBowTerms;
}

}  // namespace

void BowFactors::judge(double switch_sigmas) {
  if (!any()) return;
  std::vector<double> chi2;
  chi2.reserve(terms_.edges.size());
  for (const EdgeBow& edge : terms_.edges) chi2.push_back(misfit(edge, bow_));
  constexpr double kMedianOfChi2 = 0.789;  // of chi^2 with three degrees of freedom over three
  const double variance = std::max(1.0, middle_of(chi2) / kMedianOfChi2);  // never surer than the bias says
  for (std::size_t e = 0; e < chi2.size(); ++e) trust_[e] = switch_of(chi2[e] / variance, switch_sigmas) / variance;
}

void BowFactors::add_edge(std::size_t edge, const EdgeTerm& term, System system) const {
  const auto bow = system.g.size() - kBowTerms;
  const Eigen::Matrix<double, 6, kBowTerms> C = -terms_.edges[edge].motion;
  const Eigen::Matrix<double, 6, kBowTerms> WC = term.W * C;
  for (const Moved& node : {term.i, term.j}) {
    if (node.column < 0) continue;
    const Eigen::Matrix<double, 6, kBowTerms> block = node.J.transpose() * WC;
    add_block(system.entries, node.column, bow, block);
    add_block(system.entries, bow, node.column, block.transpose());
  }
  add_block(system.entries, bow, bow, BowMatrix(C.transpose() * WC));
  system.g.tail<kBowTerms>() += WC.transpose() * term.x;
}

void BowFactors::add_to(System system, double variance, double unit_variance) const {
  if (!any()) return;
  const auto at = system.g.size() - kBowTerms;
  BowMatrix H = BowMatrix::Zero();
  BowVector g = BowVector::Zero();
  for (std::size_t e = 0; e < terms_.edges.size(); ++e) {
    const double weight = variance * trust_[e];
    H += weight * terms_.edges[e].H;
    g += weight * (terms_.edges[e].H * bow_ - terms_.edges[e].g);
  }
  const BowMatrix held = unit_variance * terms_.prior.inverse();
  add_block(system.entries, at, at, BowMatrix(H + held));
  system.g.tail<kBowTerms>() += g + held * bow_;
}

void BowFactors::move(const Eigen::VectorXd& solution) {
  if (any()) bow_ += solution.tail<kBowTerms>();
}

BowEstimate BowFactors::estimate(const Solve& solve, Eigen::Index all_unknowns, double unit_variance) const {
  BowEstimate out{bow_, BowMatrix::Zero(), terms_.prior};
  for (int k = 0; k < kBowTerms; ++k) {
    const Eigen::VectorXd column = Eigen::VectorXd::Unit(all_unknowns, all_unknowns - kBowTerms + k);
    out.covariance.col(k) = unit_variance * solve(column).tail<kBowTerms>();
  }
  out.covariance = 0.5 * (out.covariance + out.covariance.transpose()).eval();
  return out;
}

}  // namespace enamel::pipeline
