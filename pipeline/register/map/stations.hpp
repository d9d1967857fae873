// Places along a scan whose distances say how far a whole arch can be trusted: at 4, 25, 75 and 96 % of the way from
// one end of what was scanned to the other, and how surely the map knows them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "pipeline/register/map/pose_graph.hpp"

namespace enamel::pipeline {

inline constexpr std::array kStationShares{0.04, 0.25, 0.75, 0.96};
/// chosen: what a fused surface is off by at one place however well its poses are known
inline constexpr double kSurfaceSigma_mm = 1e-3;

struct Station {
  double share = 0;       ///< of the way
  std::size_t node = 0;   ///< keyframe that looks at it …
  std::size_t burst = 0;  ///< … and its burst
  Vec3d p_model = Vec3d::Zero();
};

struct StationDistance {
  std::size_t a = 0, b = 0;  ///< into the stations
  double distance_mm = 0;
  double sigma_mm = 0;  ///< of the poses and of the surface at both places
};

struct Stations {
  std::vector<Station> stations;
  std::vector<StationDistance> distances;  ///< of every two, a < b
  double way_mm = 0;                       ///< from end to end, over the surface
};

/// The way is the longest of the shortest ways over the points looked at, from neighbour to neighbour as the edges
/// lead: passes beside each other count once. It begins at the end that lies nearer to node 0. `bursts`: of each node.
/// Empty where nothing was solved or the way is shorter than `least_way_mm`.
[[nodiscard]] Stations find_stations(const SolvedGraph& graph, const std::vector<MapEdge>& edges,
                                     const std::vector<std::size_t>& bursts, const Vec3d& looked_at,
                                     double least_way_mm);

}  // namespace enamel::pipeline
