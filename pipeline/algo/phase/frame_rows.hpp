// One row of a burst as floats, and the physical mask that all modes share. Private to algo/phase.
#pragma once

#include <array>
#include <vector>

#include "pipeline/algo/phase/phase.hpp"

namespace enamel::algo {

using FrameRows = std::array<std::vector<float>, 4>;

void load_row(const BurstView& view, std::size_t row, FrameRows& rows);

/// The three frames that the phase rests on: a, b, c, in any order.
struct MaskFrames {
  const float* a;
  const float* b;
  const float* c;
};

/// kDark, kSaturated, kNoisy or kNone of every pixel of a row, from its phase frames and the sigma of its phase.
void mask_row(const MaskFrames& frames, std::size_t width, const NoiseModel& noise, const PhaseConfig& config,
              const float* sigma, PixelReject* reject);

}  // namespace enamel::algo
