#include <algorithm>
#include <array>

#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/mode_m/micro_phase_rows.hpp"
#include "pipeline/decode/mode_m/micro_refit_rows.hpp"
#include "pipeline/decode/phase/frame_rows.hpp"
#include "pipeline/decode/phase/polar_rows.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_m/micro_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void solve_micro(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps) {
  constexpr float kThird = 1.0F / 3, kInvRoot3 = 0.57735027F;  // layout: weights of the frames
  solve_burst(view, noise, config, {0, 2, 3, 1}, maps, [](float i0, float i2, float i3, const NoiseModel& n) {
    const float a = kThird * (i0 + i2 + i3);
    const float c = kThird * (2 * i0 - i2 - i3);
    const float s = kInvRoot3 * (i3 - i2);
    // First-order propagation of the three frames' noise through atan2(s, c).
    const float e0 = 2 * kThird * s, e2 = kThird * s - kInvRoot3 * c, e3 = kThird * s + kInvRoot3 * c;
    return ThreeFrames{a, c, s, e0 * e0 * n.variance(i0) + e2 * e2 * n.variance(i2) + e3 * e3 * n.variance(i3)};
  });
}

struct ThirdSums {
  alignas(64) std::array<float, kPolarStretch> of_pixel;
};

void third_loop(const PhaseMaps& m, const float* weights, std::size_t at, std::size_t count, ThirdSums& out) {
  const float* __restrict cosine = &m.cosine_dn[at], * __restrict sine = &m.sine_dn[at], * __restrict weight = weights;
  float* __restrict sum = out.of_pixel.data();
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < count; ++u) {
    const float c = cosine[u], s = sine[u], b2 = c * c + s * s + 1e-6F;
    sum[u] += select(weight[u] != 0, c * (c * c - 3 * s * s) / (b2 * root(b2)), 0);
  }
}

/// Stretches of a row are added up side by side first.
double third_sum(const PhaseMaps& m, const float* weight, std::size_t at, std::size_t width) {
  ThirdSums sums;
  sums.of_pixel.fill(0);
  for (std::size_t from = 0; from < width; from += kPolarStretch)
    third_loop(m, weight + from, at + from, std::min(kPolarStretch, width - from), sums);
  for (std::size_t half = kPolarStretch / 2; half > 0; half /= 2)
    for (std::size_t j = 0; j < half; ++j) sums.of_pixel[j] += sums.of_pixel[j + half];
  return static_cast<double>(sums.of_pixel[0]);
}

void correct_loop(const float* wrap_counts, float a1_rad, std::size_t at, std::size_t width, PhaseMaps& m) {
  const float* __restrict cosine = &m.cosine_dn[at], * __restrict sine = &m.sine_dn[at], * __restrict wraps = wrap_counts;
  float* __restrict phase = &m.phase_rad[at];
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float c = cosine[u], s = sine[u], b2 = c * c + s * s + 1e-6F;
    phase[u] -= select(wraps[u] > kNoSurface, a1_rad * (s * (3 * c * c - s * s) / (b2 * root(b2))), 0);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(solve_micro);
HWY_EXPORT(third_sum);
HWY_EXPORT(correct_loop);

double third_harmonic_row(const PhaseMaps& maps, const float* counted, std::size_t at, std::size_t width) {
  return HWY_DYNAMIC_DISPATCH(third_sum)(maps, counted, at, width);
}

void correct_third_row(const float* wraps, float a1_rad, std::size_t at, std::size_t width, PhaseMaps& maps) {
  HWY_DYNAMIC_DISPATCH(correct_loop)(wraps, a1_rad, at, width, maps);
}

void compute_micro_phase(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps) {
  HWY_DYNAMIC_DISPATCH(solve_micro)(view, noise, config, maps);
}

}  // namespace enamel::pipeline
#endif
