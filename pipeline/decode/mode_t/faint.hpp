// Faint pixels of mode T. The noise of three frames' phase changes by 1.73 along a fringe, that of four does not
// change, and frame 3 joins once its sign is known (polarity.hpp). So a pixel is judged by four frames: by its light
// alone, and not by where in the fringe it lies. Three frames' mask would leave surfaces in the dark striped, and cut
// their segments into pieces that say too little of the code.
#pragma once

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {

/// Sigma of the phase by four frames with b = +1 over that by the first three. derived: of frames of one variance,
/// which have 1/2 and 1/2 + cos^2(phi) of it over B^2.
[[nodiscard, gnu::always_inline]] inline float fourth_frame_gain(float cosine, float sine) noexcept {
  const float c2 = cosine * cosine, b2 = c2 + sine * sine + 1e-6F;
  return root(b2 / (b2 + 2 * c2));
}

/// After compute_phase: pixels that are kNoisy by three frames only, and have a frame 3, become kNone.
void admit_faint(const PhaseConfig& config, PhaseMaps& maps);

}  // namespace enamel::pipeline
