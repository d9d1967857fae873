// Rows of micro_light.hpp, compiled per instruction set. Private to pipeline/decode.
#pragma once

#include <cstddef>

#include "pipeline/decode/mode_m/micro_refit_rows.hpp"
#include "pipeline/decode/phase/light_change.hpp"

namespace enamel::pipeline {

void micro_light_row(const CodeRow& row, const NoiseModel& noise, float max_residual, std::size_t width,
                     const LightRow& out);

/// Shares that light which changed added to C, to S and to the code frame less A; of: what they are shares of.
struct LightShares {
  const float *cosine, *sine, *rest;
  LampLight of;
};

/// In place.
void take_light_off_row(const LightShares& shares, float black_dn, std::size_t width, const MovedRow& out);

}  // namespace enamel::pipeline
