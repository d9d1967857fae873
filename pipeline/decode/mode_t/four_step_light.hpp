// Mode T's share in phase/light_change.hpp: what its pixels show of light that changed by itself, and taking it off.
//   C, S: of frames 0 to 2      fourth frame: I_3, predicted as A + b S
#pragma once

#include <span>

#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/phase/light_change.hpp"

namespace enamel::pipeline {

/// burst: after apply_polarity. Whether light changed.
[[nodiscard]] bool find_four_step_light(const KnownBurst& burst, const NoiseModel& noise, float max_residual,
                                        const LightChangeConfig& config, LampLight of, LightChange& light);

/// Brings cosine_dn, sine_dn, code_dn and phase_rad back to what they were before apply_polarity, less that light. The
/// phase of a span's pixel is the one nearest to the middle of its cell: it may leave [-pi, pi) a little.
void take_off_light(const LightChange& light, std::span<const CellSpan> spans, const PolarityMaps& polarity,
                    float black_dn, PhaseMaps& maps);

}  // namespace enamel::pipeline
