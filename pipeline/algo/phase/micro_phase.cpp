#include "pipeline/algo/phase/micro_phase.hpp"

#include <algorithm>
#include <limits>

#include "pipeline/algo/phase/frame_rows.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr float kThird = 1.0F / 3;
constexpr float kInvRoot3 = 0.57735027F;
constexpr float kLargestResidue_rad = 0.2F;

struct RowOut {
  float* mean;
  float* cosine;
  float* sine;
  float* code;
  float* modulation;
  float* phase;
  float* sigma;
};

void solve_row(const FrameRows& rows, std::size_t width, const NoiseModel noise, float saturated_dn, const RowOut& o) {
  const float* __restrict i0 = rows[0].data();
  const float* __restrict i1 = rows[1].data();
  const float* __restrict i2 = rows[2].data();
  const float* __restrict i3 = rows[3].data();
  float* __restrict mean = o.mean, * __restrict cosine = o.cosine, * __restrict sine = o.sine, * __restrict code = o.code;
  float* __restrict modulation = o.modulation, * __restrict phase = o.phase, * __restrict sigma = o.sigma;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float a = kThird * (i0[u] + i2[u] + i3[u]);
    const float c = kThird * (2 * i0[u] - i2[u] - i3[u]);
    const float s = kInvRoot3 * (i3[u] - i2[u]);
    const float b2 = c * c + s * s + 1e-6F;
    // First-order propagation of the three frames' noise through atan2(s, c).
    const float e0 = 2 * kThird * s, e2 = kThird * s - kInvRoot3 * c, e3 = kThird * s + kInvRoot3 * c;
    const float var =
        e0 * e0 * noise.variance(i0[u]) + e2 * e2 * noise.variance(i2[u]) + e3 * e3 * noise.variance(i3[u]);
    mean[u] = a;
    cosine[u] = c;
    sine[u] = s;
    code[u] = select(i1[u] < saturated_dn, i1[u] - a, std::numeric_limits<float>::quiet_NaN());
    modulation[u] = root(b2);
    phase[u] = atan2_poly(s, c);
    sigma[u] = root(var) / b2;
  }
}

}  // namespace

void compute_micro_phase(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps) {
  maps.resize(view.width, view.height);
  const auto width = static_cast<std::size_t>(view.width);
  FrameRows rows;
  for (auto& row : rows) row.resize(width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(view.height); ++v) {
    load_row(view, v, rows);
    const std::size_t at = v * width;
    solve_row(rows, width, noise, config.saturation * noise.full_scale_dn,
              {&maps.mean_dn[at], &maps.cosine_dn[at], &maps.sine_dn[at], &maps.code_dn[at], &maps.modulation_dn[at],
               &maps.phase_rad[at], &maps.sigma_rad[at]});
    mask_row({rows[0].data(), rows[2].data(), rows[3].data()}, width, noise, config, &maps.sigma_rad[at],
             &maps.reject[at]);
  }
}

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
  const double a1 = out.pixels > 0 ? -2.0 / 3.0 * sum / out.pixels : 0;
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
