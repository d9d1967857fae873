// Which stops look at the same surface, foretold from their patches and from where the axes put them.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/register/icp/view_camera.hpp"
#include "pipeline/register/stops/stop.hpp"

namespace enamel::pipeline {

/// Share of i's samples that j sees too: within `gate_mm` of j's surface along its normal, both facing the same side.
/// T_j_i: where i is believed to be. Every few samples are asked: their share is known to some percent. 0 for an empty
/// stop.
[[nodiscard]] double overlap_of(const MapNode& i, const MapNode& j, const ViewCamera& camera, const Pose& T_j_i,
                                double gate_mm);

struct StopPair {
  std::size_t i = 0, j = 0;  ///< j < i
  double overlap = 0;        ///< the smaller of both ways
};
/// All pairs that share at least `min_overlap`, by i, then j.
[[nodiscard]] std::vector<StopPair> overlapping_pairs(const std::vector<Stop>& stops,
                                                      const std::vector<Pose>& T_model_cam, const ViewCamera& camera,
                                                      double gate_mm, double min_overlap);

}  // namespace enamel::pipeline
