// One pixel of mode T from any three of its frames, because the fourth is saturated or saw another surface. At rest
// fixed weights solve it (docs/decode.md §1: one pseudo-inverse per mask pattern), frame 3 as if b were +1:
//   without frame 0   A = (I1+I3)/2, S = (I3-I1)/2, C = A - I2
//   without frame 1   A = (I0+I2)/2, C = (I0-I2)/2, S = I3 - A
//   without frame 2   A = (I1+I3)/2, S = (I3-I1)/2, C = I0 - A
//   without frame 3   A = (I0+I2)/2, C = (I0-I2)/2, S = A - I1
// and in motion the equations of frame_solve.hpp. Private to pipeline/decode.
#pragma once

#include <array>
#include <cstddef>

#include "pipeline/decode/mode_t/frame_solve.hpp"
#include "pipeline/decode/phase/noise_model.hpp"

namespace enamel::pipeline {

/// Values of frames 0 to 3 above black. What the missing one holds is not looked at.
using Frames = std::array<float, 4>;

/// Of frames that nothing changes in between.
[[nodiscard]] FourStepPixel solve_without(std::size_t missing, const Frames& x) noexcept;

/// At mid-burst, of frames taken as the pixel turned by `change` (less than a quarter turn a frame); harmonic: B2/B,
/// left out of the result.
[[nodiscard]] FourStepPixel solve_without(std::size_t missing, const Frames& x, const PixelChange& change,
                                          float harmonic) noexcept;

/// Of the phase atan2(S, C), by first-order propagation of the three frames' noise with the weights at rest, rad.
[[nodiscard]] float sigma_without(std::size_t missing, const FourStepPixel& pixel, const Frames& x,
                                  const NoiseModel& noise) noexcept;

}  // namespace enamel::pipeline
