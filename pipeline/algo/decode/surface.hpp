// Absolute phase to the output maps: depth, its sigma, points, normals, order.
#pragma once

#include "pipeline/algo/decode/decoded_burst.hpp"
#include "pipeline/algo/phase/phase.hpp"
#include "pipeline/algo/triangulate/normals.hpp"
#include "pipeline/algo/triangulate/ray_depth.hpp"

namespace enamel::algo {

/// turn: Phi = phase_rad + 2 pi turn. Pixels that are still kNone get depth or kOutOfRange; all others NaN.
/// scratch keeps its memory between calls.
void make_surface(const PhaseMaps& maps, const Map<std::int16_t>& turn, const RayDepth& rays, const PhaseRipple& ripple,
                  const NormalConfig& config, std::vector<float>& scratch, DecodedBurst& out);

/// 1/z of every second pixel of image row v, an even one, for whoever needs slopes before the phase is final; NaN where
/// a pixel is rejected or out of range by more than the share `beyond` of its ends. phase: theirs, in place of that of
/// `maps`.
void sparse_inverse_depth_row(const PhaseMaps& maps, const Map<std::int16_t>& turn, const RayDepth& rays, float beyond,
                              int v, const float* phase_rad, float* inverse_depth);

}  // namespace enamel::algo
