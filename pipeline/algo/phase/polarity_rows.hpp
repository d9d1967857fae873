// The loop of apply_polarity over one row. Private to algo/phase.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pipeline/algo/phase/noise_model.hpp"
#include "pipeline/algo/phase/polarity.hpp"

namespace enamel::algo {

/// What the solution of a row's pixels depends on, spread over the row: spans are a dozen pixels long, too short for
/// loops of their own.
struct PolarityRow {
  const float *sign, *low_flip, *high_flip;  ///< flips: added to the distance from the cell's borders
  const float* origin;                       ///< phase of the cell's lower border in the pixel's own wrap
  const std::int16_t* turn;
};

/// Pixels begin … end-1 of the row whose first pixel is `at`.
void solve_polarity_row(const PolarityRow& row, std::size_t at, std::size_t begin, std::size_t end,
                        const NoiseModel& noise, const PolarityConfig& config, PhaseMaps& maps, PolarityMaps& out);

}  // namespace enamel::algo
