#include "pipeline/decode/phase/phase_ripple.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "pipeline/decode/phase/ripple_rows.hpp"
#include "pipeline/decode/phase/row_memory.hpp"

namespace enamel::pipeline {
namespace {

using Complex = std::complex<double>;
constexpr std::int32_t kMostRowStep = 3;  ///< layout: stride over rows

/// Of so many rows one is asked: as few as give enough pixels.
std::int32_t row_step(std::span<const CellSpan> spans) {
  double pixels = 0;
  for (const CellSpan& s : spans) pixels += s.whole ? s.end - s.begin : 0;
  return std::clamp(static_cast<std::int32_t>(pixels / kEnoughPixels), 1, kMostRowStep);
}

/// e^{i N m phi} for m = 1 … kRippleTerms by repeated multiplication.
void add_phase(double phase_rad, int steps, PhaseMoments& sums) {
  const Complex base = std::polar(1.0, steps * phase_rad);
  Complex power = base;
  for (std::size_t m = 0; m < kRippleTerms; ++m) {
    sums.cosines[m] += power.real();
    sums.sines[m] += power.imag();
    power *= base;
  }
  sums.pixels += 1;
}

/// Whether three spans from `first` on are half fringes of one run, all whole.
bool hang_together(std::span<const CellSpan> spans, std::size_t first) {
  if (first + 2 >= spans.size()) return false;
  const CellSpan &a = spans[first], &b = spans[first + 1], &c = spans[first + 2];
  const std::int32_t step = b.cell - a.cell;
  return a.whole && b.whole && c.whole && a.row == c.row && a.end == b.begin && b.end == c.begin &&
         std::abs(step) == 1 && c.cell - b.cell == step;
}

/// By how much of itself the number of pixels a radian rises over span k, from one end of its half fringe to the other
/// in Phi: from two half fringes that are two apart, because ripple makes even and odd ones differ. Those on both
/// sides; at a run's end the span itself and the one after the next.
double crowding(std::span<const CellSpan> spans, std::size_t k) {
  const auto length = [&](std::size_t i) { return spans[i].end - spans[i].begin; };
  for (const std::size_t back : {std::size_t{1}, std::size_t{0}, std::size_t{2}}) {
    if (back > k || !hang_together(spans, k - back)) continue;
    const std::size_t first = k - back;
    return 0.25 * (spans[first + 2].cell - spans[first].cell) * (length(first + 2) - length(first)) / length(k);
  }
  return 0;
}

}  // namespace

void PhaseMoments::add(const PhaseMoments& other) noexcept {
  pixels += other.pixels;
  for (std::size_t m = 0; m < kRippleTerms; ++m) {
    cosines[m] += other.cosines[m];
    sines[m] += other.sines[m];
  }
}

double PhaseRipple::error_rad(double phase_rad) const noexcept {
  const Complex base = std::polar(1.0, steps * phase_rad);
  Complex power = base;
  double error = 0;
  for (std::size_t m = 0; m < kRippleTerms; ++m) {
    error += cosine[m] * power.real() + sine[m] * power.imag();
    power *= base;
  }
  return error;
}

PhaseMoments phase_moments(std::span<const CellSpan> spans, const PhaseMaps& maps, const WeighSpan& weigh) {
  PhaseMoments sums;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  RowMemory weight(width);
  const std::int32_t step = row_step(spans);
  double crowded = 0;
  for (std::size_t k = 0; k < spans.size();) {
    const std::int32_t row = spans[k].row;
    const bool asked = row % step == 0;
    std::fill_n(weight.data(), width, 0.0F);
    for (; k < spans.size() && spans[k].row == row; ++k) {
      const CellSpan& s = spans[k];
      if (!asked || !s.whole) continue;
      const float w = weigh(s);
      std::fill_n(weight.data() + s.begin, s.end - s.begin, w);
      crowded += static_cast<double>(w) * (s.end - s.begin) * crowding(spans, k);
      sums.pixels += s.end - s.begin;
    }
    if (!asked) continue;
    MomentLanes lanes;
    add_moments_row(maps, weight.data(), static_cast<std::size_t>(row) * width, width, lanes);
    for (std::size_t m = 0; m < kRippleTerms; ++m) {
      for (const float x : lanes.cosines[m]) sums.cosines[m] += static_cast<double>(x);
      for (const float x : lanes.sines[m]) sums.sines[m] += static_cast<double>(x);
    }
  }
  // Without ripple, <sin 4m phi> of a half fringe whose pixels crowd as 1 + g (phi/pi - 1/2) is -g/(4m pi).
  for (std::size_t m = 0; m < kRippleTerms; ++m)
    sums.sines[m] += crowded / (sums.steps * static_cast<double>(m + 1) * std::numbers::pi);
  return sums;
}

PhaseMoments phase_moments(std::span<const CellSpan> spans, const PhaseMaps& maps) {
  return phase_moments(spans, maps, [](const CellSpan&) { return 1.0F; });
}

void each_asked_span(std::span<const CellSpan> spans, const std::function<void(const CellSpan& span)>& visit) {
  const std::int32_t step = row_step(spans);
  for (const CellSpan& s : spans)
    if (s.whole && s.row % step == 0) visit(s);
}

PhaseMoments phase_moments(std::span<const float> phase_rad, int steps) {
  PhaseMoments sums;
  sums.steps = steps;
  for (const float phase : phase_rad) add_phase(static_cast<double>(phase), steps, sums);
  return sums;
}

PhaseRipple level(const PhaseMoments& moments, std::size_t terms) {
  PhaseRipple ripple;
  ripple.steps = moments.steps;
  if (!(moments.pixels > 0)) return ripple;
  for (std::size_t m = 0; m < std::min(terms, kRippleTerms); ++m) {
    const double scale = 2 / (moments.steps * static_cast<double>(m + 1) * moments.pixels);
    ripple.cosine[m] = scale * moments.sines[m];
    ripple.sine[m] = -scale * moments.cosines[m];
  }
  return ripple;
}

double amplitude_variance(std::size_t m, double pixels) noexcept {
  const auto order = static_cast<double>(m);
  return pixels > 0 ? 1 / (8 * order * order * pixels) : 1;
}

PhaseRipple shrink(const PhaseRipple& ripple, const PhaseMoments& moments) {
  PhaseRipple out = ripple;
  for (std::size_t m = 0; m < kRippleTerms; ++m) {
    const double variance = amplitude_variance(m + 1, moments.pixels);
    for (double* a : {&out.cosine[m], &out.sine[m]}) *a *= *a * *a / (*a * *a + variance);
  }
  return out;
}

void correct_phase(const PhaseRipple& ripple, std::span<float> phase_rad) {
  // The error is smooth: a table of 1024 steps over the fold and straight lines between keep it to 1e-5 of itself.
  constexpr std::size_t kSteps = 1024;  // layout: of the table
  std::vector<float> table(kSteps + 1);
  const double fold = 2 * std::numbers::pi / ripple.steps;
  for (std::size_t k = 0; k <= kSteps; ++k)
    table[k] = static_cast<float>(ripple.error_rad(fold * static_cast<double>(k) / kSteps));
  const auto per_rad = static_cast<float>(kSteps / fold);
  for (float& phase : phase_rad) {
    if (!(std::abs(phase) < 100.0F)) continue;  // NaN stays NaN
    const float x = phase * per_rad, whole = std::floor(x), share = x - whole;
    const auto cell =
        static_cast<std::size_t>(static_cast<std::ptrdiff_t>(whole) & static_cast<std::ptrdiff_t>(kSteps - 1));
    phase -= table[cell] + share * (table[cell + 1] - table[cell]);
  }
}

}  // namespace enamel::pipeline
