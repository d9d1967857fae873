// The bow of the rig as a latent term of the pose graph: every edge is off by what it makes of the same three numbers.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/register/map/bow.hpp"

namespace enamel::pipeline {

/// About the minimum of an edge. Two views that are shifted against each other see a bow as a turn: additive along a
/// sweep, so nothing contradicts it. Views that are rolled or tilted against each other are turned otherwise, and their
/// surfaces do not fit.
struct EdgeBow {
  Eigen::Matrix<double, 6, kBowTerms> motion = Eigen::Matrix<double, 6, kBowTerms>::Zero();
  ///< (rho*omega, tau) as MapEdge::H: what each mm of a term keeps the edge's pose from
  BowMatrix H = BowMatrix::Zero();  ///< of what no pose takes away: min over a of a^T H a - 2 g^T a; mm^-2
  BowVector g = BowVector::Zero();
};

/// Nothing is solved for where there are no edges.
struct BowTerms {
  std::vector<EdgeBow> edges;               ///< one a MapEdge
  BowMatrix prior = BowMatrix::Identity();  ///< covariance, about no bow; mm^2
};

struct BowEstimate {
  BowVector bow = BowVector::Zero();
  BowMatrix covariance = BowMatrix::Identity(), prior = BowMatrix::Identity();  ///< mm^2
};

/// The last unknowns of a system. Private to pose_graph.
class BowFactors {
 public:
  explicit BowFactors(BowTerms terms) : terms_(std::move(terms)), trust_(terms_.edges.size(), 1.0) {}
  [[nodiscard]] bool any() const { return !terms_.edges.empty(); }
  [[nodiscard]] Eigen::Index unknowns() const { return any() ? kBowTerms : 0; }
  [[nodiscard]] Vector6 motion_of(std::size_t edge) const { return terms_.edges[edge].motion * bow_; }

  /// Scale of what the surfaces say by its median over all edges; the trust in each by what remains.
  void judge(double switch_sigmas);

  struct System {
    std::vector<Eigen::Triplet<double>>& entries;
    Eigen::VectorXd& g;
  };
  /// A node that an edge moves: its first column, the edge's motion by that of the node. column < 0: it stays.
  struct Moved {
    Eigen::Index column;
    Matrix6 J;
  };
  struct EdgeTerm {
    Matrix6 W;  ///< the edge's information …
    Vector6 x;  ///< … and its residual
    Moved i, j;
  };
  /// By the edge's pose.
  void add_edge(std::size_t edge, const EdgeTerm& term, System system) const;
  /// By what lies between surfaces, `variance` those of poses, floored as sigmas are; and the prior, which counts
  /// against `unit_variance`.
  void add_to(System system, double variance, double unit_variance) const;
  void move(const Eigen::VectorXd& solution);
  using Solve = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
  [[nodiscard]] BowEstimate estimate(const Solve& solve, Eigen::Index all_unknowns, double unit_variance) const;

 private:
  BowTerms terms_;
  std::vector<double> trust_;
  BowVector bow_ = BowVector::Zero();
};

}  // namespace enamel::pipeline
