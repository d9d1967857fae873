// The loops of micro_phase.hpp over one row. Private to pipeline/decode.
#pragma once

#include <cstddef>

#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

/// Sum of cos 3phi over the row's pixels whose `counted` is not 0.
[[nodiscard]] double third_harmonic_row(const PhaseMaps& maps, const float* counted, std::size_t at, std::size_t width);

/// Subtracts a1 sin 3phi where there is a surface (CodeRow::wraps).
void correct_third_row(const float* wraps, float a1_rad, std::size_t at, std::size_t width, PhaseMaps& maps);

}  // namespace enamel::pipeline
