#include "pipeline/register/map/pose_graph.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "pipeline/register/map/graph_terms.hpp"

namespace enamel::pipeline {
namespace {

/// Information of an edge in units of mm^-2: no direction surer than the bias allows; where the surface says
/// nothing, what texture says.
Matrix6 information(const MapEdge& edge, const GraphConfig& config) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(edge.H);
  const double total =
      edge.H.trace() / 2;  // about the sum of weights: the trace of JJ^T is one for the normal, one or so more
  const double turn = config.bias_rad * config.rho_mm, shift = config.bias_mm;
  Matrix6 out = Matrix6::Zero();
  Matrix6 weak = Matrix6::Zero();  // projection on what shape leaves free
  for (int k = 0; k < 6; ++k) {
    const double value = eigen.eigenvalues()[k];
    const Vector6 v = eigen.eigenvectors().col(k);
    if (value < config.weak_eigenvalue * total) {
      weak += v * v.transpose();
      continue;
    }
    const double bias2 = v.head<3>().squaredNorm() * turn * turn + v.tail<3>().squaredNorm() * shift * shift;
    out += v * v.transpose() / (1 / value + bias2);
  }
  return out + weak * edge.H_texture * weak;
}

/// A motion (rho*omega, tau) about a node's own centre, as the motion of node j's axes about the edge's centre.
Matrix6 carry(const Eigen::Matrix3d& R_j_model, const Vec3d& from_own_centre, double rho_mm) {
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>() = R_j_model;
  out.bottomRightCorner<3, 3>() = R_j_model;
  out.bottomLeftCorner<3, 3>() = -R_j_model * cross_matrix(from_own_centre) / rho_mm;
  return out;
}

/// Where node poses are turned about: in the middle of the surface that its edges saw. Any point would do; one amid the
/// surface keeps turns and shifts apart.
std::vector<Vec3d> centres_of(const std::vector<Pose>& poses, const std::vector<MapEdge>& edges) {
  std::vector<Vec3d> sums(poses.size(), Vec3d::Zero());
  std::vector<int> counts(poses.size(), 0);
  for (const MapEdge& edge : edges) {
    const Vec3d at = poses[edge.j] * edge.centre;
    for (const std::size_t node : {edge.i, edge.j}) {
      sums[node] += at;
      ++counts[node];
    }
  }
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] /= std::max(counts[k], 1);
  return sums;
}

class Solver {
 public:
  Solver(std::vector<Pose> poses, const std::vector<MapEdge>& edges, const GraphConfig& config, Landmarks landmarks,
         std::vector<PosePrior> priors, BowTerms bow)
      : poses_(std::move(poses)),
        edges_(edges),
        config_(config),
        switches_(edges.size(), 1.0),
        landmarks_(std::move(landmarks)),
        priors_(std::move(priors)),
        bow_(std::move(bow)),
        distance_variances_(landmarks_.asked(), 0.0) {
    for (const MapEdge& edge : edges) information_.push_back(information(edge, config));
  }

  SolvedGraph run() {
    for (int round = 0; round < config_.rounds; ++round) {
      judge();
      step();
    }
    judge();
    const Normal at_end = normal_equations();
    SolvedGraph out{poses_, switches_, sigma0_, 0, landmarks_.at(), distance_variances_, nullptr, {}};
    for (std::size_t e = 0; e < edges_.size(); ++e) out.switched_off += switches_[e] < 0.5 ? 1 : 0;
    out.covariance =
        std::make_shared<const GraphCovariance>(at_end.H / variance_of_unit_weight(), at_end.centres, config_.rho_mm);
    if (bow_.any()) out.bow = bow_at(at_end);
    return out;
  }

 private:
  [[nodiscard]] Vector6 residual(std::size_t e) const {
    const MapEdge& edge = edges_[e];
    const Pose T_j_i = poses_[edge.j].inverse() * poses_[edge.i];
    const Vector6 x = motion_between(edge.T_j_i, T_j_i, edge.centre, config_.rho_mm);
    return bow_.any() ? Vector6(x - bow_.motion_of(e)) : x;
  }

  /// Scale of the residuals by their median over all edges, which false ones hardly move; then the switches.
  void judge() {
    std::vector<double> chi2;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const Vector6 x = residual(e);
      chi2.push_back(x.dot(information_[e] * x) / 6);
    }
    constexpr double kMedianOfChi2 = 0.891;  // of chi^2 with six degrees of freedom over six
    const double variance = chi2.empty() ? 1 : std::max(middle_of(chi2) / kMedianOfChi2, 1e-12);
    sigma0_ = std::sqrt(variance);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (edges_[e].loop) switches_[e] = switch_of(chi2[e] / variance, config_.switch_sigmas);
    }
    landmarks_.judge(poses_, config_.switch_sigmas);
    bow_.judge(config_.switch_sigmas);
  }

  struct Normal {
    std::vector<Vec3d> centres;  ///< that the nodes' motions turn about
    Eigen::SparseMatrix<double> H;
    Eigen::VectorXd g;
  };

  [[nodiscard]] Normal normal_equations() const {
    const auto unknowns = static_cast<Eigen::Index>(6 * (poses_.size() - 1)) + landmarks_.unknowns() + bow_.unknowns();
    Normal out{centres_of(poses_, edges_), {unknowns, unknowns}, Eigen::VectorXd::Zero(unknowns)};
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const MapEdge& edge = edges_[e];
      const Eigen::Matrix3d R_j_model = poses_[edge.j].linear().transpose();
      const Vec3d centre = poses_[edge.j] * edge.centre;
      const Matrix6 A = carry(R_j_model, centre - out.centres[edge.i], config_.rho_mm);
      const Matrix6 B = -carry(R_j_model, centre - out.centres[edge.j], config_.rho_mm);
      const Matrix6 W = switches_[e] * information_[e];
      const Vector6 x = residual(e);
      add(entries, edge.i, edge.i, A.transpose() * W * A);
      add(entries, edge.j, edge.j, B.transpose() * W * B);
      add(entries, edge.i, edge.j, A.transpose() * W * B);
      add(entries, edge.j, edge.i, B.transpose() * W * A);
      if (edge.i > 0) out.g.segment<6>(at(edge.i)) += A.transpose() * W * x;
      if (edge.j > 0) out.g.segment<6>(at(edge.j)) += B.transpose() * W * x;
      if (bow_.any()) bow_.add_edge(e, {W, x, {at(edge.i), A}, {at(edge.j), B}}, {entries, out.g});
    }
    landmarks_.add_to({entries, out.g}, {poses_, out.centres, config_.rho_mm}, sigma0_ * sigma0_);
    bow_.add_to({entries, out.g}, std::max(1.0, sigma0_ * sigma0_), variance_of_unit_weight());
    add_priors(priors_, {entries, out.g, poses_, out.centres}, config_.rho_mm, variance_of_unit_weight());
    out.H.setFromTriplets(entries.begin(), entries.end());
    for (Eigen::Index k = 0; k < unknowns; ++k) out.H.coeffRef(k, k) += kHold;
    return out;
  }

  /// What the residuals show, at least what the information foretells: a bias that all edges share leaves no residual.
  /// Of the edges that meet at a node, as many as there are for each node, only one is counted as independent.
  [[nodiscard]] double variance_of_unit_weight() const {
    if (!config_.edges_share_errors) return sigma0_ * sigma0_;
    const double edges_a_node = static_cast<double>(edges_.size()) / static_cast<double>(poses_.size() - 1);
    return std::max(1.0, sigma0_ * sigma0_) * std::max(1.0, edges_a_node);
  }

  void step() {
    const Normal normal = normal_equations();
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal.H);
    if (factor.info() != Eigen::Success) return;
    const Eigen::VectorXd move = factor.solve(-normal.g);
    for (std::size_t k = 1; k < poses_.size(); ++k) {
      poses_[k] = apply_motion(move.segment<6>(at(k)), normal.centres[k], config_.rho_mm, poses_[k]);
    }
    const auto by_graph = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd { return factor.solve(v); };
    distance_variances_ = landmarks_.variances(by_graph, normal.g.size(), sigma0_ * sigma0_);
    landmarks_.move(move);
    bow_.move(move);
  }

  [[nodiscard]] BowEstimate bow_at(const Normal& normal) const {
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal.H);
    return bow_.estimate([&](const Eigen::VectorXd& v) -> Eigen::VectorXd { return factor.solve(v); }, normal.g.size(),
                         variance_of_unit_weight());
  }

  static Eigen::Index at(std::size_t node) { return static_cast<Eigen::Index>(6 * (node - 1)); }
  static void add(std::vector<Eigen::Triplet<double>>& entries, std::size_t a, std::size_t b, const Matrix6& block) {
    if (a == 0 || b == 0) return;
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c) entries.emplace_back(at(a) + r, at(b) + c, block(r, c));
    }
  }

  static constexpr double kHold =
      1e-3;  // mm^-2: a node that no edge holds in some direction stays; edges have 1e5 and more

  std::vector<Pose> poses_;
  const std::vector<MapEdge>& edges_;
  GraphConfig config_;
  std::vector<Matrix6> information_;
  std::vector<double> switches_;
  double sigma0_ = 1;
  LandmarkFactors landmarks_;
  std::vector<PosePrior> priors_;
  BowFactors bow_;
  std::vector<double> distance_variances_;
};

}  // namespace

SolvedGraph solve_graph(std::vector<Pose> poses, const std::vector<MapEdge>& edges, const GraphConfig& config,
                        Landmarks landmarks, std::vector<PosePrior> priors, BowTerms bow) {
  if (poses.size() < 2 || (edges.empty() && priors.empty())) {
    return {std::move(poses), std::vector<double>(edges.size(), 1.0), 1, 0, std::move(landmarks.at), {}, nullptr, {}};
  }
  return Solver(std::move(poses), edges, config, std::move(landmarks), std::move(priors), std::move(bow)).run();
}

}  // namespace enamel::pipeline
