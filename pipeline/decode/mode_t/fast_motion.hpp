// Whether four frames that do not close are those of a surface that moved too fast: for a motion of eps rad a frame, A,
// C and S follow from frames 0 to 2, each at its own time, and predict frame 3 as A + S or A - S (closure_rows.hpp has
// the equations). Frames in a wrong order, sent twice or left over from another burst have no such eps.
#pragma once

#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

struct FastMotion {
  double share = 0;       ///< of valid pixels that close under the motion of their block
  double motion_rad = 0;  ///< a frame interval; the middle one of the blocks
};

/// Of four-step maps before polarity.hpp, whose code_dn is I3 - A. Blocks of 64 px, motions up to 0.8 rad a frame in
/// steps of 0.05: some 10 ms for VGA, so for bursts that are rejected anyway. No valid pixels: share 0.
[[nodiscard]] FastMotion explain_by_motion(const PhaseMaps& maps);

}  // namespace enamel::pipeline
