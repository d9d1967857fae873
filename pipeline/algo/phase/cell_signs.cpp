#include "pipeline/algo/phase/cell_signs.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::algo {

Result<CellSigns> make_cell_signs(const calib::PatternValues& patterns, const calib::LensValues& projector) {
  using calib::PatternMode;
  if (patterns.mode == PatternMode::kMicro)
    return fail(ErrorCode::kPatternSet, "mode M has no polarity code: its fourth frame is a fringe of its own");
  if (patterns.mode == PatternMode::kMulti)
    return fail(ErrorCode::kPatternSet, "mode multi is a calibration set, not a burst");
  if (patterns.axis_v) return fail(ErrorCode::kPatternSet, "fringes along v are not decoded by this version");
  if (!(patterns.period_px > 2)) return fail(ErrorCode::kPatternSet, "period_px must be above 2");
  if (patterns.mode == PatternMode::kPolarity && patterns.polarity_code.empty())
    return fail(ErrorCode::kPatternSet, "polarity_code is empty");

  CellSigns cells;
  const int count = static_cast<int>(std::ceil(2.0 * projector.width / patterns.period_px)) + 1;
  const int length = static_cast<int>(patterns.polarity_code.size());
  for (int c = 0; c < count; ++c) {
    int sign = 1;
    if (patterns.mode == PatternMode::kPolarity)
      sign = patterns.polarity_code[static_cast<std::size_t>((((c + patterns.first_cell) % length) + length) % length)];
    if (patterns.mode == PatternMode::kSingle && c / 2 == patterns.marker_fringe) sign = -1;
    cells.sign.push_back(static_cast<float>(sign));
  }
  cells.informative =
      std::any_of(cells.sign.begin(), cells.sign.end(), [&](float s) { return (s > 0) != (cells.sign.front() > 0); });
  return cells;
}

}  // namespace enamel::algo
