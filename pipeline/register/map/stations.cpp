#include "pipeline/register/map/stations.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

namespace enamel::pipeline {
namespace {

using Neighbours = std::vector<std::vector<std::pair<std::size_t, double>>>;  // node -> (node, mm)
constexpr double kNoWay = std::numeric_limits<double>::infinity();

/// Shortest ways from one node (Dijkstra).
std::vector<double> ways_from(std::size_t start, const Neighbours& neighbours) {
  std::vector<double> out(neighbours.size(), kNoWay);
  std::priority_queue<std::pair<double, std::size_t>, std::vector<std::pair<double, std::size_t>>, std::greater<>> next;
  out[start] = 0;
  next.emplace(0, start);
  while (!next.empty()) {
    const auto [way, node] = next.top();
    next.pop();
    if (way > out[node]) continue;
    for (const auto& [to, step] : neighbours[node]) {
      if (way + step >= out[to]) continue;
      out[to] = way + step;
      next.emplace(out[to], to);
    }
  }
  return out;
}

std::size_t farthest(const std::vector<double>& ways) {
  std::size_t best = 0;
  for (std::size_t k = 0; k < ways.size(); ++k) {
    if (std::isfinite(ways[k]) && (ways[k] > ways[best] || !std::isfinite(ways[best]))) best = k;
  }
  return best;
}

/// Over edges that are believed: one that was switched off is no way from place to place. The hand went from each
/// keyframe to the next, whether anything ties them or not.
Neighbours neighbours_of(const std::vector<Vec3d>& points, const std::vector<MapEdge>& edges,
                         const std::vector<double>& switches) {
  Neighbours out(points.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (switches[e] < 0.5) continue;
    const MapEdge& edge = edges[e];
    const double step = (points[edge.i] - points[edge.j]).norm();
    out[edge.i].emplace_back(edge.j, step);
    out[edge.j].emplace_back(edge.i, step);
  }
  for (std::size_t k = 1; k < points.size(); ++k) {
    const double step = (points[k] - points[k - 1]).norm();
    out[k].emplace_back(k - 1, step);
    out[k - 1].emplace_back(k, step);
  }
  return out;
}

}  // namespace

Stations find_stations(const SolvedGraph& graph, const std::vector<MapEdge>& edges,
                       const std::vector<std::size_t>& bursts, const Vec3d& looked_at, double least_way_mm) {
  Stations out;
  if (!graph.covariance) return out;
  std::vector<Vec3d> points;
  points.reserve(graph.poses.size());
  for (const Pose& T : graph.poses) points.emplace_back(T * looked_at);
  const Neighbours neighbours = neighbours_of(points, edges, graph.switches);
  const std::size_t one_end = farthest(ways_from(0, neighbours));
  const std::size_t start = farthest(ways_from(one_end, neighbours));
  const std::vector<double> ways = ways_from(start, neighbours);
  out.way_mm = ways[farthest(ways)];
  if (out.way_mm < least_way_mm) return out;
  for (const double share : kStationShares) {
    const auto off = [&](double way) { return std::abs(way - share * out.way_mm); };
    const auto node = static_cast<std::size_t>(std::ranges::min_element(ways, {}, off) - ways.begin());
    out.stations.push_back({share, node, bursts[node], points[node]});
  }
  for (std::size_t a = 0; a < out.stations.size(); ++a) {
    for (std::size_t b = a + 1; b < out.stations.size(); ++b) {
      const Station& from = out.stations[a];
      const Station& to = out.stations[b];
      const double of_poses = graph.covariance->sigma_of_distance_mm({from.node, from.p_model}, {to.node, to.p_model});
      out.distances.push_back(
          {a, b, (from.p_model - to.p_model).norm(), std::hypot(of_poses, std::numbers::sqrt2 * kSurfaceSigma_mm)});
    }
  }
  return out;
}

}  // namespace enamel::pipeline
