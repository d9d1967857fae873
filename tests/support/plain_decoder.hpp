// A plain decoder of modes T and M: phase of three frames, unwrapping along the best links of each connected segment,
// the code's vote in windows, triangulation. No corrections, no smoothing, no gates of quality. It shares the lens
// formula of calib/model with the product and nothing else: the floor that the product's decoder must not fall below.
#pragma once

#include "calib/model/rig.hpp"
#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::test {

/// Camera z, mm; NaN where the frames do not tell it. Needs mode T or M along projector u, rig.noise, rig.depth_range
/// and a consistent view of the camera's size.
[[nodiscard]] Map<float> plain_decode(const calib::Rig& rig, const pipeline::BurstView& view);

}  // namespace enamel::test
