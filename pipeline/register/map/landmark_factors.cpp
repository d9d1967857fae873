#include "pipeline/register/map/landmark_factors.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "pipeline/register/map/graph_terms.hpp"

namespace enamel::pipeline {
namespace {

/// Columns of a system that a term depends on, and the term's derivative by them.
struct Part {
  Eigen::Index column;
  Eigen::MatrixXd J;
};

void add_term(LandmarkFactors::System system, const std::vector<Part>& parts, const Eigen::MatrixXd& W,
              const Eigen::VectorXd& residual) {
  for (const Part& a : parts) {
    system.g.segment(a.column, a.J.cols()) += a.J.transpose() * W * residual;
    for (const Part& b : parts) {
      const Eigen::MatrixXd block = a.J.transpose() * W * b.J;
      for (Eigen::Index r = 0; r < block.rows(); ++r) {
        for (Eigen::Index c = 0; c < block.cols(); ++c)
          system.entries.emplace_back(a.column + r, b.column + c, block(r, c));
      }
    }
  }
}

}  // namespace

LandmarkFactors::LandmarkFactors(Landmarks landmarks)
    : landmarks_(std::move(landmarks)), trust_(landmarks_.sightings.size(), 1.0) {
  for (const LandmarkSighting& s : landmarks_.sightings) information_.push_back(s.covariance.inverse());
}

Eigen::Index LandmarkFactors::column(std::size_t landmark, const Eigen::VectorXd& unknowns) const {
  return unknowns.size() - this->unknowns() + static_cast<Eigen::Index>(3 * landmark);
}

void LandmarkFactors::judge(const std::vector<Pose>& poses, double switch_sigmas) {
  if (landmarks_.sightings.empty()) return;
  std::vector<double> chi2;
  for (std::size_t n = 0; n < landmarks_.sightings.size(); ++n) {
    const LandmarkSighting& s = landmarks_.sightings[n];
    const Vec3d r = poses[s.node].inverse() * landmarks_.at[s.landmark] - s.at;
    chi2.push_back(r.dot(information_[n] * r) / 3);
  }
  constexpr double kMedianOfChi2 = 0.789;  // of chi^2 with three degrees of freedom over three
  const double variance = std::max(1.0, middle_of(chi2) / kMedianOfChi2);  // never surer than the fits say
  for (std::size_t n = 0; n < chi2.size(); ++n) trust_[n] = switch_of(chi2[n] / variance, switch_sigmas) / variance;
}

void LandmarkFactors::add_sighting(std::size_t n, System system, const Nodes& nodes, double variance) const {
  const LandmarkSighting& s = landmarks_.sightings[n];
  const Pose& T = nodes.poses[s.node];
  const Vec3d seen = T * s.at;
  const Eigen::Matrix3d W = variance * trust_[n] * T.linear() * information_[n] * T.linear().transpose();
  std::vector<Part> parts{{column(s.landmark, system.g), Eigen::Matrix3d::Identity()}};
  if (s.node > 0) {  // a motion (rho*omega, tau) takes what the node saw to seen + omega x (seen - centre) + tau
    Eigen::MatrixXd J(3, 6);
    J << cross_matrix(seen - nodes.centres[s.node]) / nodes.rho_mm, -Eigen::Matrix3d::Identity();
    parts.push_back({static_cast<Eigen::Index>(6 * (s.node - 1)), J});
  }
  add_term(system, parts, W, landmarks_.at[s.landmark] - seen);
}

void LandmarkFactors::add_distance(const LandmarkDistance& distance, System system, double variance) const {
  const Vec3d between = landmarks_.at[distance.a] - landmarks_.at[distance.b];
  const Vec3d along = between.normalized();
  const double W = variance / (distance.sigma_mm * distance.sigma_mm);
  add_term(system,
           {{column(distance.a, system.g), along.transpose()}, {column(distance.b, system.g), -along.transpose()}},
           Eigen::MatrixXd::Constant(1, 1, W), Eigen::VectorXd::Constant(1, between.norm() - distance.mm));
}

void LandmarkFactors::add_to(System system, const Nodes& nodes, double variance) const {
  const double scale = variance * landmarks_.edge_variance;
  for (std::size_t n = 0; n < landmarks_.sightings.size(); ++n) add_sighting(n, system, nodes, scale);
  if (!landmarks_.obeyed) return;
  for (const LandmarkDistance& distance : landmarks_.distances) add_distance(distance, system, scale);
}

std::vector<double> LandmarkFactors::variances(const Solve& solve, Eigen::Index all_unknowns, double variance) const {
  std::vector<double> out;
  for (const LandmarkDistance& d : landmarks_.distances) {
    const Vec3d along = (landmarks_.at[d.a] - landmarks_.at[d.b]).normalized();
    Eigen::VectorXd J = Eigen::VectorXd::Zero(all_unknowns);
    J.segment<3>(column(d.a, J)) = along;
    J.segment<3>(column(d.b, J)) = -along;
    out.push_back(J.dot(solve(J)) * variance * landmarks_.edge_variance);
  }
  return out;
}

void LandmarkFactors::move(const Eigen::VectorXd& solution) {
  for (std::size_t k = 0; k < landmarks_.at.size(); ++k) landmarks_.at[k] += solution.segment<3>(column(k, solution));
}

}  // namespace enamel::pipeline
