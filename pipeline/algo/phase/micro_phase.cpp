#include "pipeline/algo/phase/micro_phase.hpp"

#include <algorithm>
#include <vector>

#include "pipeline/algo/phase/micro_phase_rows.hpp"
#include "pipeline/algo/phase/micro_spans.hpp"

namespace enamel::algo {
namespace {

constexpr float kLargestResidue_rad = 0.2F;
constexpr double kMinPixels = 5000;  ///< standard error of a1 at most 0.007 rad

}  // namespace

ThirdHarmonic estimate_third_harmonic(std::span<const CellSpan> spans, const PhaseMaps& maps) {
  ThirdHarmonic out;
  double sum = 0;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  std::vector<float> whole(width);
  for (std::size_t k = 0; k < spans.size();) {
    const std::int32_t row = spans[k].row;
    std::fill(whole.begin(), whole.end(), 0.0F);
    for (; k < spans.size() && spans[k].row == row; ++k) {
      if (k + 1 == spans.size()) continue;
      const CellSpan &a = spans[k], &b = spans[k + 1];
      const bool fringe = a.whole && b.whole && a.row == b.row && a.end == b.begin && std::abs(a.cell - b.cell) == 1;
      if (!fringe) continue;
      std::fill(whole.begin() + a.begin, whole.begin() + b.end, 1.0F);
      out.pixels += b.end - a.begin;
      ++k;  // each half fringe counts once
    }
    sum += third_harmonic_row(maps, whole.data(), static_cast<std::size_t>(row) * width, width);
  }
  const double a1 = out.pixels >= kMinPixels ? -2.0 / 3.0 * sum / out.pixels : 0;
  out.a1_rad = static_cast<float>(std::abs(a1) <= static_cast<double>(kLargestResidue_rad) ? a1 : 0);
  return out;
}

void correct_third_harmonic(std::span<const CellSpan> spans, std::span<const CellSpan> more, float a1_rad,
                            PhaseMaps& maps) {
  if (a1_rad == 0) return;
  const int w = maps.phase_rad.width();
  each_inside_row(spans, more, w, maps.phase_rad.height(), [&](std::int32_t v, const float* inside) {
    correct_third_row(inside, a1_rad, maps.phase_rad.index(0, v), static_cast<std::size_t>(w), maps);
  });
}

void place_spans(std::span<const CellSpan> spans, int width, int height, Map<std::int16_t>& turn) {
  if (turn.width() != width || turn.height() != height) turn = Map<std::int16_t>(width, height);
  for (const CellSpan& s : spans) {
    const auto first = turn.pixels().begin() + static_cast<std::ptrdiff_t>(turn.index(s.begin, s.row));
    std::fill(first, first + (s.end - s.begin), static_cast<std::int16_t>(turn_of_cell(s.cell)));
  }
}

}  // namespace enamel::algo
