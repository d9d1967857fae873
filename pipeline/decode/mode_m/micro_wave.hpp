// The projector's waveform in mode M once orders and motion are known. The four frames show harmonics h_n of the
// fringes and hc_n of the code's finer fringe, of which blur leaves less. What they add is predicted from the pixel's
// own phase, order, motion and light and taken off its frames. What is left of the code frame tells how far off they
// were: with phi_k and theta the phases of a pixel's fringe and code, c = cos theta, r = 1 + 1/L and g the code's gain,
//   R/B = dhc_2 T_2(c) + dhc_3 T_3(c) - dh_2 g (cos 3phi cos theta + r sin 3phi sin theta) - dh_3 cos 3phi
// because three frames that take a wave for a cosine are off by -dh_2 sin 3phi in phase, by dh_2 cos 3phi in B and by
// dh_3 B cos 3phi in A. Every pixel votes: surfaces need not cover whole fringes.
#pragma once

#include "pipeline/decode/mode_m/micro_refit.hpp"
#include "pipeline/decode/phase/raw_frames.hpp"
#include "pipeline/decode/phase/waveform.hpp"

namespace enamel::pipeline {

struct MicroWave {
  Waveform fringe, code;
};

/// Takes the wave out of the maps before any order is known: of the three phase frames by their own solution, of the
/// code frame by F. kNoisy is decided anew; saturated and dark pixels stay. code_dn becomes NaN where the response is
/// so flat that the code frame says little.
void linearise_micro(const Waveform& wave, const PhaseConfig& config, PhaseMaps& maps);

/// Beforehand `maps` is what some waveform left, motion still within; afterwards what `wave` leaves, by the phase and
/// motion that `maps` showed. Of pixels of a surface; those of unknown order keep their code. sigma_rad and reject
/// stay.
void take_off_harmonics(const RawFrames& raw, const Map<std::int16_t>& wraps, const MicroCode& code,
                        const MicroMotion& motion, const MicroWave& wave, PhaseMaps& maps);

/// The wave anew, from what `wave` left of the code frame in burst.maps. max_residual: of B, beyond which a pixel sees
/// an edge or a glint.
[[nodiscard]] MicroWave refit_wave(const MicroBurst& burst, const MicroMotion& motion, float max_residual,
                                   const MicroWave& wave);

}  // namespace enamel::pipeline
