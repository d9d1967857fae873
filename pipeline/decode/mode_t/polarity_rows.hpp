// The loop of apply_polarity over one row. Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pipeline/decode/mode_t/polarity.hpp"
#include "pipeline/decode/phase/noise_model.hpp"

namespace enamel::pipeline {

/// What a pixel's cell says, as bits.
enum CellBits : std::uint8_t {
  kMinus = 1,      ///< b = -1
  kLowFlip = 2,    ///< b changes at the cell's lower border ...
  kHighFlip = 4,   ///< ... at its upper border
  kUpperHalf = 8,  ///< phase [-pi, 0)
  kOutside = 16,   ///< in no span: frame 3 counts as useless, which leaves such pixels as they are
};

/// What the solution of a row's pixels depends on, spread over the row: spans are a dozen pixels long, too short for
/// loops of their own.
struct PolarityRow {
  const std::uint8_t* cell;  ///< CellBits
  const std::int16_t* wraps;
};

/// Pixels begin … end-1 of the row whose first pixel is `at`.
void solve_polarity_row(const PolarityRow& row, std::size_t at, std::size_t begin, std::size_t end,
                        const NoiseModel& noise, const PolarityConfig& config, PhaseMaps& maps, PolarityMaps& out);

}  // namespace enamel::pipeline
