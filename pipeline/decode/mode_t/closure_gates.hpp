// Whether the four frames of a four-step burst belong together, in this order. Private to pipeline/decode.
#pragma once

#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

/// Share of valid pixels whose fourth frame is A + S or A - S within half of |S| + half of B/2 and noise. Four
/// 90-degree frames in the right order give nearly 1 (only flips' blur and depth edges fall out); a permutation breaks
/// the identity over a good part of the fringe. Frame 3 saturated: not counted.
[[nodiscard]] double closure_share(const PhaseMaps& maps, const NoiseModel& noise);

/// What motion and second harmonic leave of the closure residual, as median over blocks. A frame k of another
/// time is off by a phase d: of the two columns B sin and B cos of the residual, which motion fills with opposite
/// signs, it fills but one, B (d/2) (sin + cos) beside an apparent motion. Light and texture that change during the
/// burst disturb that column as much as any other: `unrest` is their part where b = -1, to which an odd frame adds
/// none.
struct OddFrame {
  float shift_rad = 0;  ///< d
  float unrest = 0;     ///< of B, on the same scale as shift_rad
  float sigma_rad = 0;  ///< of a block's shift, by the noise of the frames: what no odd frame leaves of shift_rad
  /// Of A: by which frames 0 and 2 are brighter than 1 and 3 beside what motion explains. A frame whose exposure
  /// differs by d has d/2 or d: its mean over whole fringes.
  float exposure_step = 0;
  std::size_t blocks = 0;  ///< that could be asked: with pixels whose four frames all count, and b = +1
};
/// burst: errors of motion, light and harmonic; block_px: of the blocks.
[[nodiscard]] OddFrame find_odd_frame(const KnownBurst& burst, const NoiseModel& noise, int block_px);

}  // namespace enamel::pipeline
