#include "pipeline/algo/phase/phase_ripple.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "pipeline/algo/phase/ripple_rows.hpp"

namespace enamel::algo {
namespace {

using Complex = std::complex<double>;
constexpr std::int32_t kRowStep = 3;  ///< a third of a burst's pixels gives an amplitude to 1e-3 rad

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
  std::vector<float> weight(width);
  for (auto next = spans.begin(); next != spans.end();) {
    const std::int32_t row = next->row;
    std::fill(weight.begin(), weight.end(), 0.0F);
    for (; next != spans.end() && next->row == row; ++next) {
      if (!next->whole || row % kRowStep != 0) continue;
      std::fill(weight.begin() + next->begin, weight.begin() + next->end, weigh(*next));
      sums.pixels += next->end - next->begin;
    }
    if (row % kRowStep != 0) continue;
    MomentLanes lanes;
    add_moments_row(maps, weight.data(), static_cast<std::size_t>(row) * width, width, lanes);
    for (std::size_t m = 0; m < kRippleTerms; ++m) {
      for (const float x : lanes.cosines[m]) sums.cosines[m] += static_cast<double>(x);
      for (const float x : lanes.sines[m]) sums.sines[m] += static_cast<double>(x);
    }
  }
  return sums;
}

PhaseMoments phase_moments(std::span<const CellSpan> spans, const PhaseMaps& maps) {
  return phase_moments(spans, maps, [](const CellSpan&) { return 1.0F; });
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
  constexpr std::size_t kSteps = 1024;
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

}  // namespace enamel::algo
