// Which bursts stand for a scan, and which of them look at the same surface. Private to register/map.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "pipeline/register/map/refine_map.hpp"

namespace enamel::pipeline {

/// Indices of bursts, ascending; the first burst always.
[[nodiscard]] std::vector<std::size_t> choose_keyframes(const std::vector<MapBurst>& bursts, double work_distance_mm,
                                                        const MapConfig& config);

struct KeyframePair {
  std::size_t i = 0, j = 0;  ///< into the keyframes, j < i
  bool loop = false;
};
/// Ordered by i, then j; each pair once.
[[nodiscard]] std::vector<KeyframePair> choose_pairs(const std::vector<MapBurst>& bursts,
                                                     const std::vector<std::size_t>& keyframes, double work_distance_mm,
                                                     const MapConfig& config);

}  // namespace enamel::pipeline
