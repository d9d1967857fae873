// Turns of all segments, decided or not, for whoever needs the shape of a surface before its orders are sure. Private
// to pipeline/decode.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/order.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// One burst's; keeps its memory between bursts. Not thread-safe.
struct LikelyWraps {
  Map<std::int16_t> wraps;  ///< Phi = phase + 2 pi wraps; kNoWraps outside all segments

  struct Vote {
    std::int32_t component, shift, pixels;
  };
  std::vector<Vote> votes;                ///< of decided segments
  std::vector<std::int32_t> most_common;  ///< shift of each component; kNobodyDecided
};

/// Of an undecided segment the shift that most decided pixels of its component have, since a surface goes on; its own
/// cheapest where none is decided. wraps: resized to width x height. components: their number.
void find_likely_wraps(std::span<const Segment> segments, std::span<const SegmentOrder> orders, std::int32_t components,
                       int width, int height, LikelyWraps& out);

}  // namespace enamel::pipeline
