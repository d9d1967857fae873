#include "pipeline/decode/mode_t/cell_signs.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "calib/model/pattern.hpp"
#include "pipeline/decode/mode_t/chosen.hpp"

namespace enamel::pipeline {
namespace {

/// A window of the code that is repeated `fringes` further on.
struct Repeat {
  int cell = 0, cells = 0, fringes = 0;
};

Repeat longest_repeat(const CellSigns& signs, int orders) {
  Repeat longest;
  for (int fringes = 1; fringes < orders; ++fringes) {
    int run = 0;
    for (int c = 0; c + 2 * fringes < signs.cells(); ++c) {
      const bool alike = signs.at(c) * signs.at(c + 2 * fringes) > 0;
      run = alike ? run + 1 : 0;
      if (run > longest.cells) longest = {c + 1 - run, run, fringes};
    }
  }
  return longest;
}

int repeats_after(const std::vector<float>& sign) {
  for (std::ptrdiff_t cells = 2; cells < std::ssize(sign); cells += 2)
    if (std::equal(sign.begin() + cells, sign.end(), sign.begin())) return static_cast<int>(cells / 2);
  return 0;
}

}  // namespace

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
  for (int c = 0; c < count; ++c) cells.sign.push_back(static_cast<float>(calib::polarity_of_cell(patterns, c)));
  cells.informative =
      std::any_of(cells.sign.begin(), cells.sign.end(), [&](float s) { return (s > 0) != (cells.sign.front() > 0); });
  cells.repeats_after = repeats_after(cells.sign);
  return cells;
}

Result<void> check_windows_differ(const CellSigns& signs, double span_fringes) {
  const int orders = static_cast<int>(std::floor(span_fringes)) + 1;
  const Repeat r = longest_repeat(signs, orders);
  if (r.cells <= kLongestAlike) return {};
  std::string window;
  for (int c = r.cell; c < r.cell + r.cells; ++c) window += signs.at(c) > 0 ? '+' : '-';
  return fail(ErrorCode::kPatternAmbiguous,
              "polarity_code shows the window " + window + " (" + std::to_string(r.cells) +
                  " half fringes) at two of the " + std::to_string(orders) +
                  " fringe orders that the depth range leaves open, " + std::to_string(r.fringes) + " apart");
}

}  // namespace enamel::pipeline
