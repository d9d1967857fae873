// Absolute phase to the output maps: depth, its sigma, points, order.
#pragma once

#include "pipeline/algo/decode/decoded_burst.hpp"
#include "pipeline/algo/phase/polarity.hpp"
#include "pipeline/algo/triangulate/ray_depth.hpp"

namespace enamel::algo {

/// Pixels that are still kNone get depth or kOutOfRange; all others NaN. inverse_depth as 1/z, NaN = none.
void make_surface(const PhaseMaps& maps, const PolarityMaps& polarity, const RayDepth& rays, float fourth_rad,
                  Map<float>& inverse_depth, DecodedBurst& out);

/// 1/z alone, for whoever needs slopes before the phase is final; NaN where a pixel is rejected or out of range.
void make_inverse_depth(const PhaseMaps& maps, const PolarityMaps& polarity, const RayDepth& rays,
                        Map<float>& inverse_depth);

}  // namespace enamel::algo
