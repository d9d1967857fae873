// The textbook's solution of four frames a quarter of a period apart, no polarity in them: phase and modulation, and
// neither sigma nor mask. What phase.hpp does beyond it is measured against it.
#pragma once

#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::test {

/// phi = atan2(I3 - I1, I0 - I2) in [-pi, pi], error below 1e-6; B = half the length of that vector, DN (docs/decode.md
/// §1). Both are finite everywhere, 0 where the frames are alike. view must be consistent; maps of another size are
/// made anew.
void four_step(const pipeline::BurstView& view, Map<float>& phase_rad, Map<float>& modulation_dn);

}  // namespace enamel::test
