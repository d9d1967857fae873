// The circle of 360 degrees: stops of one swing whose neighbours overlap all round. Laid on each other one after the
// other they come back to where they began, but for what laying is off by; the graph spreads that over all of them.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/register/map/pose_graph.hpp"
#include "pipeline/register/stops/stop.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

struct Circle {
  double swing_deg = 0;
  std::size_t stops = 0;
  double chain_mm = 0;    ///< all round by edges alone: how far the first stop's surface comes out from itself …
  double chain_deg = 0;   ///< … and by how much it is turned
  double by_axes_mm = 0;  ///< between last and first stop as the axes put them, against how they fit each other
  double after_mm = 0;    ///< the same as they are in the end
};

/// `edges`: between stops, by index. `by_axes`, `solved`: T_model_cam. A stop is in one circle at most; where several
/// stand at the same angles, the first. No circle where a neighbour is missing.
[[nodiscard]] std::vector<Circle> find_circles(const std::vector<Stop>& stops, const std::vector<MapEdge>& edges,
                                               const std::vector<Pose>& by_axes, const std::vector<Pose>& solved);

/// How far a stop's surface lies from where an edge puts it, at the edge's centre.
[[nodiscard]] double edge_gap_mm(const MapEdge& edge, const std::vector<Pose>& T_model_cam);

}  // namespace enamel::pipeline
