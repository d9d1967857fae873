// Absolute phase to the output maps: depth, its sigma, points, normals, order.
#pragma once

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/steps/decoded_burst.hpp"
#include "pipeline/decode/triangulate/normals.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"

namespace enamel::pipeline {

/// turn: Phi = phase_rad + 2 pi turn. Pixels that are still kNone get depth or kOutOfRange; all others NaN.
/// scratch keeps its memory between calls.
void make_surface(const PhaseMaps& maps, const Map<std::int16_t>& turn, const RayDepth& rays, const PhaseRipple& ripple,
                  const NormalConfig& config, std::vector<float>& scratch, DecodedBurst& out);

}  // namespace enamel::pipeline
