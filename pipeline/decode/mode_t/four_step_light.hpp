// Mode T's share in phase/light_change.hpp: what its pixels show of light that changed by itself, and taking it off.
//   C, S: of frames 0 to 2      fourth frame: I_3, predicted as A + b S
#pragma once

#include <span>

#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/phase/light_change.hpp"

namespace enamel::pipeline {

/// What is asked of a burst.
struct LightQuestion {
  const NoiseModel& noise;
  float max_residual;  ///< of B; beyond it the pixel sees an edge or a glint
  float motion_rad;    ///< of the burst, a frame interval
  const LightChangeConfig& config;
  LampLight of;
};

/// burst: after apply_polarity. Whether light changed. Pixels near full scale, which may rest on three frames, are not
/// asked.
[[nodiscard]] bool find_four_step_light(const KnownBurst& burst, const LightQuestion& question, LightChange& light);

/// Brings cosine_dn, sine_dn, code_dn and phase_rad back to what they were before apply_polarity, less that light. The
/// phase of a span's pixel is the one nearest to the middle of its cell: it may leave [-pi, pi) a little.
void take_off_light(const LightChange& light, std::span<const CellSpan> spans, const PolarityMaps& polarity,
                    float black_dn, PhaseMaps& maps);

}  // namespace enamel::pipeline
