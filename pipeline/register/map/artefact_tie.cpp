#include "pipeline/register/map/artefact_tie.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/register/map/artefact_match.hpp"

namespace enamel::pipeline {
namespace {

/// One for all diameters that are nearly the same: their mean.
std::vector<double> radii_of(const KnownArtefact& artefact) {
  std::vector<double> sorted = artefact.diameters_mm;
  std::ranges::sort(sorted);
  std::vector<double> out;
  for (std::size_t from = 0; from < sorted.size();) {
    std::size_t to = from;
    double sum = 0;
    while (to < sorted.size() && sorted[to] - sorted[from] < kSameDiameter_mm) sum += sorted[to++];
    out.push_back(sum / static_cast<double>(to - from) / 2);
    from = to;
  }
  return out;
}

/// Weighted mean of where its sightings put a ball.
Vec3d mean_of(const std::vector<LandmarkSighting>& sightings, std::size_t landmark, const std::vector<Pose>& poses) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Vec3d g = Vec3d::Zero();
  for (const LandmarkSighting& s : sightings) {
    if (s.landmark != landmark) continue;
    const Eigen::Matrix3d R = poses[s.node].linear(), W = R * s.covariance.inverse() * R.transpose();
    H += W;
    g += W * (poses[s.node] * s.at);
  }
  return H.inverse() * g;
}

Landmarks landmarks_of(const std::vector<BallCluster>& clusters, const std::vector<std::size_t>& names,
                       const MapTie& tie, const std::vector<Pose>& poses) {
  Landmarks out;
  const double bias2 = tie.config.bias_mm * tie.config.bias_mm;
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    for (const Sighting& seen : clusters[k].seen) {
      const FoundSphere& s = seen.sphere;
      const double wider = tie.artefact.diameters_mm[names[k]] / 2 - s.radius_mm;
      out.sightings.push_back(
          {k, seen.keyframe, s.centre + wider * s.per_radius, s.covariance + bias2 * Eigen::Matrix3d::Identity()});
    }
    out.at.push_back(mean_of(out.sightings, k, poses));
  }
  for (const auto& d : tie.artefact.distances) {
    const auto a = std::ranges::find(names, d.i), b = std::ranges::find(names, d.j);
    if (a == names.end() || b == names.end()) continue;
    out.distances.push_back({static_cast<std::size_t>(a - names.begin()), static_cast<std::size_t>(b - names.begin()),
                             d.mm, std::hypot(d.sigma_mm, tie.config.bias_mm)});
  }
  return out;
}

/// The variance of edges, in units of what they foretell, that explains how far the distances are off (variance
/// components, Helmert): a bias that all edges share adds up along an arch where noise averages out.
double edge_variance_of(const Landmarks& landmarks, const SolvedGraph& free) {
  double unexplained = 0, foretold = 0;
  for (std::size_t n = 0; n < landmarks.distances.size(); ++n) {
    const LandmarkDistance& d = landmarks.distances[n];
    const double off = (free.landmarks[d.a] - free.landmarks[d.b]).norm() - d.mm;
    unexplained += off * off - d.sigma_mm * d.sigma_mm;
    foretold += free.distance_variances[n];
  }
  return std::max(1.0, unexplained / std::max(foretold, 1e-12));
}

std::vector<ArtefactFacts::Distance> compare(const Landmarks& before, const SolvedGraph& free,
                                             const std::vector<Vec3d>& after, const std::vector<std::size_t>& names,
                                             const MapTie& tie) {
  std::vector<ArtefactFacts::Distance> out;
  for (std::size_t n = 0; n < before.distances.size(); ++n) {
    const LandmarkDistance& d = before.distances[n];
    ArtefactFacts::Distance row;
    for (const auto& certified : tie.artefact.distances) {
      if (certified.i == names[d.a] && certified.j == names[d.b]) row.certified = certified;
    }
    row.before_mm = (before.at[d.a] - before.at[d.b]).norm();
    row.before_sigma_mm = std::sqrt(free.distance_variances[n]);
    row.after_mm = (after[d.a] - after[d.b]).norm();
    row.held = std::abs(row.after_mm - d.mm) <= tie.config.held_sigmas * d.sigma_mm;
    out.push_back(row);
  }
  return out;
}

}  // namespace

std::vector<FoundSphere> find_artefact(const SurfacePatch& patch, const calib::LensValues& lens,
                                       const KnownArtefact& artefact, const SphereConfig& config) {
  std::vector<FoundSphere> out;
  for (const double radius : radii_of(artefact)) {
    const auto found = find_spheres(patch, lens, radius, config);
    out.insert(out.end(), found.begin(), found.end());
  }
  return out;
}

ArtefactFacts tie_to_artefact(const std::vector<std::vector<FoundSphere>>& of_node, const std::vector<MapEdge>& edges,
                              const MapTie& tie, SolvedGraph& solved) {
  ArtefactFacts facts;
  facts.seen.assign(tie.artefact.diameters_mm.size(), 0);
  std::vector<BallCluster> clusters;
  for (BallCluster& cluster : cluster_balls(of_node, solved.poses, tie.config.reach_mm)) {
    if (cluster.seen.size() >= tie.config.min_sightings) {
      clusters.push_back(std::move(cluster));
    } else {
      facts.other += cluster.seen.size();
    }
  }
  const BallMatch match = match_balls(clusters, tie.artefact, tie.config.tolerance_mm);
  facts.why = match.why;
  if (!match.why.empty()) {
    for (const BallCluster& cluster : clusters) facts.other += cluster.seen.size();
    return facts;
  }
  for (std::size_t k = 0; k < clusters.size(); ++k) facts.seen[match.sphere[k]] = clusters[k].seen.size();
  Landmarks landmarks = landmarks_of(clusters, match.sphere, tie, solved.poses);
  landmarks.obeyed = false;
  const SolvedGraph free = solve_graph(solved.poses, edges, tie.graph, landmarks);
  landmarks.obeyed = true;
  landmarks.edge_variance = facts.edge_variance = edge_variance_of(landmarks, free);
  solved = solve_graph(std::move(solved.poses), edges, tie.graph, landmarks);
  facts.distances = compare(landmarks, free, solved.landmarks, match.sphere, tie);
  facts.used = true;
  return facts;
}

}  // namespace enamel::pipeline
