#include "pipeline/algo/phase/micro_phase.hpp"

#include <algorithm>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr float kLargestResidue_rad = 0.2F;
constexpr double kMinPixels = 5000;  ///< standard error of a1 at most 0.007 rad

}  // namespace

ThirdHarmonic estimate_third_harmonic(std::span<const CellSpan> spans, const PhaseMaps& maps) {
  ThirdHarmonic out;
  double sum = 0;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  for (std::size_t k = 0; k + 1 < spans.size(); ++k) {
    const CellSpan &a = spans[k], &b = spans[k + 1];
    const bool fringe = a.whole && b.whole && a.row == b.row && a.end == b.begin && std::abs(a.cell - b.cell) == 1;
    if (!fringe) continue;
    const std::size_t at = static_cast<std::size_t>(a.row) * width;
    float part = 0;
    for (std::size_t i = at + static_cast<std::size_t>(a.begin); i < at + static_cast<std::size_t>(b.end); ++i) {
      const float c = maps.cosine_dn[i], s = maps.sine_dn[i], b2 = c * c + s * s + 1e-6F;
      part += c * (c * c - 3 * s * s) / (b2 * root(b2));  // cos 3phi
    }
    sum += static_cast<double>(part);
    out.pixels += b.end - a.begin;
    ++k;  // each half fringe counts once
  }
  const double a1 = out.pixels >= kMinPixels ? -2.0 / 3.0 * sum / out.pixels : 0;
  out.a1_rad = static_cast<float>(std::abs(a1) <= static_cast<double>(kLargestResidue_rad) ? a1 : 0);
  return out;
}

void correct_third_harmonic(std::span<const CellSpan> spans, float a1_rad, PhaseMaps& maps) {
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  for (const CellSpan& span : spans) {
    const std::size_t at = static_cast<std::size_t>(span.row) * width;
    const std::size_t begin = at + static_cast<std::size_t>(span.begin), end = at + static_cast<std::size_t>(span.end);
    const float* __restrict cosine = maps.cosine_dn.pixels().data();
    const float* __restrict sine = maps.sine_dn.pixels().data();
    float* __restrict phase = maps.phase_rad.pixels().data();
    ENAMEL_INDEPENDENT
    for (std::size_t i = begin; i < end; ++i) {
      const float c = cosine[i], s = sine[i], b2 = c * c + s * s + 1e-6F;
      phase[i] -= a1_rad * (s * (3 * c * c - s * s) / (b2 * root(b2)));
    }
  }
}

void place_spans(std::span<const CellSpan> spans, int width, int height, Map<std::int16_t>& turn) {
  if (turn.width() != width || turn.height() != height) turn = Map<std::int16_t>(width, height);
  for (const CellSpan& s : spans) {
    const auto first = turn.pixels().begin() + static_cast<std::ptrdiff_t>(turn.index(s.begin, s.row));
    std::fill(first, first + (s.end - s.begin), static_cast<std::int16_t>(turn_of_cell(s.cell)));
  }
}

}  // namespace enamel::algo
