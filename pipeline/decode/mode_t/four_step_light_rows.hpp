// The loop of four_step_light.hpp over a row. Private to pipeline/decode.
#pragma once

#include <cmath>
#include <cstddef>

#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/phase/light_change.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {

/// The three frames' own S and the sign of the fourth: polarity.hpp, backwards.
[[nodiscard, gnu::always_inline]] inline float sine_of_three(float sine, float weight, float residual) {
  return sine + 0.5F * std::abs(weight) * select(residual == residual, residual, 0);
}

/// What a row's pixels say of light that changed. reject: of its first pixel; max_residual: of the closure over B.
void four_step_light_row(const PixelRow& row, const PixelReject* reject, const NoiseModel& noise, float max_residual,
                         std::size_t width, const LightRow& out);

}  // namespace enamel::pipeline
