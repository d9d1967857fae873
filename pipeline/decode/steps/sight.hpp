// What light did to a burst beside drawing fringes: glare, metal, another lamp, fog.
#pragma once

#include "pipeline/decode/phase/noise_model.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/types/sight.hpp"

namespace enamel::pipeline {

/// From the physical mask of the three-frame solution, before anything else is rejected: trouble and its place,
/// spoilt_share, veil_dn.
[[nodiscard]] Sight look_at(const NoiseModel& noise, const PhaseMaps& maps);

}  // namespace enamel::pipeline
