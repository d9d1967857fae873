// Points of the model that several nodes see, and certified distances between them, as terms of the pose graph.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// A landmark as one node saw it.
struct LandmarkSighting {
  std::size_t landmark = 0, node = 0;
  Vec3d at = Vec3d::Zero();  ///< in the node's frame
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
};
struct LandmarkDistance {
  std::size_t a = 0, b = 0;
  double mm = 0, sigma_mm = 1;
};
struct Landmarks {
  std::vector<Vec3d> at;  ///< in the model's frame, where they are believed to be
  std::vector<LandmarkSighting> sightings;
  std::vector<LandmarkDistance> distances;
  bool obeyed = true;        ///< false: distances are asked about and tie nothing
  double edge_variance = 1;  ///< edges are less sure than they look by this factor: what their biases have in common
};

/// Three unknowns a landmark, behind those of the nodes. Private to pose_graph.
class LandmarkFactors {
 public:
  explicit LandmarkFactors(Landmarks landmarks);
  [[nodiscard]] Eigen::Index unknowns() const { return static_cast<Eigen::Index>(3 * landmarks_.at.size()); }
  [[nodiscard]] std::size_t asked() const { return landmarks_.distances.size(); }
  [[nodiscard]] const std::vector<Vec3d>& at() const { return landmarks_.at; }

  /// Scale of the sightings' residuals by their median; the trust in each by what remains.
  void judge(const std::vector<Pose>& poses, double switch_sigmas);

  struct System {
    std::vector<Eigen::Triplet<double>>& entries;
    Eigen::VectorXd& g;
  };
  struct Nodes {
    const std::vector<Pose>& poses;
    const std::vector<Vec3d>& centres;  ///< that their motions turn about
    double rho_mm;
  };
  /// variance: of the edges' residuals in units of their information, which the terms are weighed against.
  void add_to(System system, const Nodes& nodes, double variance) const;
  /// Of each distance, mm^2: J H^-1 J^T for each, H in units of `variance`. solve: by H.
  using Solve = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
  [[nodiscard]] std::vector<double> variances(const Solve& solve, Eigen::Index all_unknowns, double variance) const;
  /// By the solution's last unknowns().
  void move(const Eigen::VectorXd& solution);

 private:
  [[nodiscard]] Eigen::Index column(std::size_t landmark, const Eigen::VectorXd& unknowns) const;
  void add_sighting(std::size_t n, System system, const Nodes& nodes, double variance) const;
  void add_distance(const LandmarkDistance& distance, System system, double variance) const;

  Landmarks landmarks_;
  std::vector<Eigen::Matrix3d> information_;
  std::vector<double> trust_;
};

}  // namespace enamel::pipeline
