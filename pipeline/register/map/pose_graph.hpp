// Poses that agree best with what pairs of them were measured to be to each other.
// Each edge keeps the quadratic of its alignment about its minimum (as Koide et al., RA-L 2021, keep the error itself),
// information by what the whole graph leaves (a-posteriori variance), and a switch on edges that close loops
// (dynamic covariance scaling, Agarwal et al., ICRA 2013). Gauss-Newton, sparse Cholesky.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/register/map/bow_factors.hpp"
#include "pipeline/register/map/graph_covariance.hpp"
#include "pipeline/register/map/landmark_factors.hpp"
#include "pipeline/register/map/pose_prior.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// Node i as seen from node j, and how surely.
struct MapEdge {
  std::size_t i = 0, j = 0;
  Pose T_j_i = Pose::Identity();        ///< measured
  Vec3d centre = Vec3d::Zero();         ///< of the common surface, in the frame of node j
  Matrix6 H = Matrix6::Identity();      ///< of a motion (rho*omega, tau) of i about `centre`, axes of j; mm^-2
  Matrix6 H_texture = Matrix6::Zero();  ///< the same of directions that shape leaves free and texture holds
  bool loop = false;                    ///< not of two that followed each other: may be false, may be switched off
};

struct GraphConfig {
  double rho_mm = 4.5;            ///< as IcpConfig::rho_mm
  double bias_rad = 5e-5;         ///< what an alignment is off by however many points it has: calibration, ripple …
  double bias_mm = 1e-3;          ///< … so that no direction ever looks surer
  double weak_eigenvalue = 0.01;  ///< of H / points, as PriorConfig: below it an edge says nothing of the direction
  int rounds = 8;
  bool edges_share_errors = true;  ///< in covariances: the edges of a node see one patch, and its errors in all of them
  double switch_sigmas = 4;        ///< a loop edge beyond is trusted less and less; a false one lies hundreds away
};

struct SolvedGraph {
  std::vector<Pose> poses;
  std::vector<double> switches;                       ///< of each edge: 1 trusted … 0 off
  double sigma0 = 1;                                  ///< residuals beside what the edges' information foretells
  int switched_off = 0;                               ///< loop edges below one half
  std::vector<Vec3d> landmarks;                       ///< model frame
  std::vector<double> distance_variances;             ///< mm^2, of each distance between them
  std::shared_ptr<const GraphCovariance> covariance;  ///< null where there was nothing to solve
  std::optional<BowEstimate> bow = {};                ///< where one was asked for
};

/// Node 0 stays. `poses`: where the nodes are believed to be, near enough for one linearisation a round; every node is
/// connected to node 0, or has a prior. Landmarks or a bow, not both. Deterministic.
[[nodiscard]] SolvedGraph solve_graph(std::vector<Pose> poses, const std::vector<MapEdge>& edges,
                                      const GraphConfig& config, Landmarks landmarks = {},
                                      std::vector<PosePrior> priors = {}, BowTerms bow = {});

}  // namespace enamel::pipeline
