// Fifth step of a burst: absolute phase to the output maps: depth, its sigma, points, normals, order.
#pragma once

#include "pipeline/decode/steps/decoded_burst.hpp"
#include "pipeline/decode/steps/refined_phase.hpp"
#include "pipeline/decode/triangulate/normals.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"

namespace enamel::pipeline {

/// Pixels that are still kNone get depth or kOutOfRange; all others NaN. ripple: taken off the phase. scratch keeps its
/// memory between calls.
void make_surface(const RefinedPhase& phase, const RayDepth& rays, const PhaseRipple& ripple,
                  const NormalConfig& config, std::vector<float>& scratch, DecodedBurst& out);

}  // namespace enamel::pipeline
