#include "pipeline/decode/mode_m/micro_phase.hpp"

#include <algorithm>
#include <vector>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/mode_m/micro_phase_rows.hpp"
#include "pipeline/decode/mode_m/micro_spans.hpp"

namespace enamel::pipeline {
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
  const double a1 = out.pixels >= kMinHarmonicPixels ? -2.0 / 3.0 * sum / out.pixels : 0;
  out.a1_rad = static_cast<float>(std::abs(a1) <= static_cast<double>(kLargestResidue_rad) ? a1 : 0);
  return out;
}

void place_spans(std::span<const CellSpan> spans, std::span<const CellSpan> unplaced, int width, int height,
                 Map<std::int16_t>& wraps) {
  if (wraps.width() != width || wraps.height() != height) wraps = Map<std::int16_t>(width, height);
  std::fill(wraps.pixels().begin(), wraps.pixels().end(), kNoWraps);
  const auto fill = [&wraps](const CellSpan& s, std::int16_t value) {
    const auto first = wraps.pixels().begin() + static_cast<std::ptrdiff_t>(wraps.index(s.begin, s.row));
    std::fill(first, first + (s.end - s.begin), value);
  };
  for (const CellSpan& s : unplaced) fill(s, kUnplacedWraps);
  for (const CellSpan& s : spans) fill(s, static_cast<std::int16_t>(wraps_of_cell(s.cell)));
}

void correct_third_harmonic(const Map<std::int16_t>& wraps, float a1_rad, PhaseMaps& maps) {
  if (a1_rad == 0) return;
  std::vector<float> wrap_counts(static_cast<std::size_t>(wraps.width()));
  for (int v = 0; v < wraps.height(); ++v) {
    take_wraps(&wraps(0, v), wrap_counts);
    correct_third_row(wrap_counts.data(), a1_rad, wraps.index(0, v), wrap_counts.size(), maps);
  }
}

}  // namespace enamel::pipeline
