// Gates on a whole burst. None is tuned to data: each says what four frames of a surface, in this order, must look
// like.
#pragma once

#include "pipeline/algo/phase/phase.hpp"

namespace enamel::algo {

/// Share of valid pixels whose fourth frame is A + S or A - S within half of |S| + half of B/2 and noise. Four
/// 90-degree frames in the right order give nearly 1 (only flips' blur and depth edges fall out); a permutation breaks
/// the identity over a good part of the fringe. Frame 3 saturated: not counted.
[[nodiscard]] double closure_share(const PhaseMaps& maps, const NoiseModel& noise);

}  // namespace enamel::algo
