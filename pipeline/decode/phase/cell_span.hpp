// Where decided segments of the code's half-fringe cells lie in the image.
#pragma once

#include <cstdint>

namespace enamel::pipeline {

/// Pixels begin … end-1 of one row that lie in absolute cell `cell`: Phi in [cell*pi, (cell+1)*pi).
struct CellSpan {
  std::int32_t row = 0, begin = 0, end = 0;
  std::int32_t cell = 0;
  bool whole = false;  ///< covers its half fringe from end to end
};

/// Turns of 2 pi between a phase in [-pi, pi) and Phi in this cell.
[[nodiscard]] constexpr std::int32_t wraps_of_cell(std::int32_t cell) noexcept { return (cell + 1) >> 1; }

}  // namespace enamel::pipeline
