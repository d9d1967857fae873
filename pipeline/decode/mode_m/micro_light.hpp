// Mode M's share in phase/light_change.hpp: what its pixels show of light that changed by itself, and taking it off.
//   C, S: of the three phase frames      fourth frame: I_1 - A, predicted as g (C cos delta - S sin delta), delta =
//   Phi/L
#pragma once

#include "pipeline/decode/mode_m/micro_refit.hpp"
#include "pipeline/decode/phase/light_change.hpp"

namespace enamel::pipeline {

/// burst and motion: those of fit_micro_motion, before undo_micro_motion. Whether light changed.
[[nodiscard]] bool find_micro_light(const MicroBurst& burst, const MicroMotion& motion, float max_residual,
                                    const LightChangeConfig& config, LampLight of, LightChange& light);

/// From the frames as they were measured. Phases may leave [-pi, pi) a little; their turns stay.
void take_off_light(const LightChange& light, float black_dn, PhaseMaps& maps);

}  // namespace enamel::pipeline
