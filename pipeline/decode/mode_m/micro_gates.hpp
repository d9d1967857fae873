// Whether the four frames of a mode M burst belong together. Private to pipeline/decode.
#pragma once

#include "pipeline/decode/mode_m/micro_refit.hpp"
#include "pipeline/decode/unwrap/links.hpp"

namespace enamel::pipeline {

/// What neither motion nor light explains of the four frames' phases: medians over blocks. Frames that a cyclic
/// permutation of the three phase frames has put in wrong places are off the code frame by a third of a step between
/// orders; a frame of another burst is off all others by a phase delta of its own. Beside a common phase, which nothing
/// shows, and motion, four phases have two more degrees of freedom: that of the code frame alone, and the skew of the
/// three others at right angles to motion. One odd frame shows in them by 0.55 to 1 delta, and a frame that is brighter
/// than the others in two like them. What a motion that was not quite found leaves looks like such a frame here and
/// there, but not like nothing else.
struct MicroOdd {
  float code_shift_rad = 0;  ///< of phi, signed: code frame alone
  float odd_shift_rad = 0;   ///< both together
  float exposure_step = 0;   ///< of A: half of what light such a frame has more, were it not its phase that differs
  /// Of what motion, light and harmonics leave beside noise: explained by these four; 0: by chance.
  double odd_share = 0;
  double explained_share = 0;  ///< of pixels with a code: predicted by the other frames to within max_residual
  float unrest = 0;            ///< of B: light that changed during the burst otherwise than the motion explains
};

/// burst and motion: those of fit_micro_motion, before undo_micro_motion; the motion is about to be taken out, so only
/// what it leaves counts.
[[nodiscard]] MicroOdd find_micro_odd(const MicroBurst& burst, const MicroMotion& motion, float max_residual);

}  // namespace enamel::pipeline
