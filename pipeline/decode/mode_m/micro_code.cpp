#include "pipeline/decode/mode_m/micro_code.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

int repeats_after(double code_ratio, int orders) {
  constexpr double kSameTurn = 1e-6;  // layout: of a whole one; for rounding
  for (int k = 1; k < orders; ++k)
    if (std::abs(std::remainder(k / code_ratio, 1.0)) < kSameTurn) return k;
  return 0;
}

std::string written(double x) {
  std::string s = std::to_string(x);
  s.erase(s.find_last_not_of('0') + 1);
  if (s.back() == '.') s.pop_back();
  return s;
}

}  // namespace

Result<MicroCode> make_micro_code(const calib::PatternValues& patterns, const calib::LensValues& projector) {
  if (patterns.mode != calib::PatternMode::kMicro) return fail(ErrorCode::kPatternSet, "the mode is not M");
  if (patterns.axis_v) return fail(ErrorCode::kPatternSet, "fringes along v are not decoded by this version");
  if (!(patterns.period_px > 2)) return fail(ErrorCode::kPatternSet, "period_px must be above 2");
  if (!(patterns.code_ratio >= 2)) return fail(ErrorCode::kPatternSet, "code_ratio must be at least 2");
  MicroCode code;
  code.inverse_ratio = static_cast<float>(1 / patterns.code_ratio);
  code.cells = static_cast<int>(std::ceil(2.0 * projector.width / patterns.period_px)) + 1;
  for (int k = 0; k <= code.cells / 2; ++k) {
    const double turn = 2 * std::numbers::pi * k / patterns.code_ratio;
    code.cosine.push_back(static_cast<float>(std::cos(turn)));
    code.sine.push_back(static_cast<float>(std::sin(turn)));
  }
  code.repeats_after = repeats_after(patterns.code_ratio, code.cells / 2 + 1);
  return code;
}

Result<void> check_orders_differ(double code_ratio, double span_fringes) {
  const int orders = static_cast<int>(std::floor(span_fringes)) + 1;
  const std::string said = "code_ratio " + written(code_ratio);
  if (code_ratio < orders) {
    return fail(ErrorCode::kPatternAmbiguous,
                said + " repeats within the " + std::to_string(orders) +
                    " fringe orders that the depth range leaves open: it must be at least " + std::to_string(orders));
  }
  for (int d = 1; d < orders; ++d) {
    const double turn = 2 * std::numbers::pi * d / code_ratio;
    if (std::abs(std::remainder(turn, 2 * std::numbers::pi)) < kLeastTurn_rad) {
      return fail(ErrorCode::kPatternAmbiguous, said + " hardly tells fringe orders apart that are " +
                                                    std::to_string(d) +
                                                    " from each other: their codes differ by under 20 degrees");
    }
  }
  return {};
}

}  // namespace enamel::pipeline
