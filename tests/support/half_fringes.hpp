// A row cut into half fringes, as the decoder's spans are: for scenes that know the phase.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/decode/phase/cell_span.hpp"

namespace enamel::test {

/// Appends the spans of a row of `width` pixels whose half fringe at pixel u is cell_at(u); none: not lit. What another
/// half fringe follows on both sides is whole.
template <class CellAt>
void cut_half_fringes(int row, int width, const CellAt& cell_at, std::vector<pipeline::CellSpan>& spans) {
  using Cell = std::optional<std::int32_t>;
  const auto at = [&](int u) -> Cell { return u >= 0 && u < width ? Cell(cell_at(u)) : Cell(); };
  for (int begin = 0, end = 0; begin < width; begin = end) {
    const Cell cell = at(begin);
    while (end < width && at(end) == cell) ++end;
    if (cell) spans.push_back({row, begin, end, *cell, at(begin - 1) && at(end)});
  }
}

}  // namespace enamel::test
