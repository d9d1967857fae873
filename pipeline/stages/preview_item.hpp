// What the fuse stage shows after each burst, for whoever looks. Immutable once published.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/model_snapshot.hpp"
#include "pipeline/types/track.hpp"
#include "protocol/base/ids.hpp"

namespace enamel::stage {

struct PreviewItem {
  BurstId burst{};
  TrackResult track;
  double surface_distance_mm = std::numeric_limits<double>::quiet_NaN();  ///< median depth, NaN = nothing decoded
  std::shared_ptr<const Map<std::uint8_t>> live;  ///< fringe-free picture, or null when the burst was not decoded
  std::shared_ptr<const ModelSnapshot> model;     ///< or null while nothing is fused
};

}  // namespace enamel::stage
