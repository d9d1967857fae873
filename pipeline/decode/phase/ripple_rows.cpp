#include "pipeline/decode/phase/ripple_rows.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "pipeline/decode/phase/polar_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/phase/ripple_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// cos and sin of 4 phi and the pixels' weights, a stretch at a time; 0 where the weight is. Their sums follow in a
/// loop of their own (polar_rows.hpp).
struct Stretch {
  alignas(64) std::array<float, kPolarStretch> cosine, sine, weight;
};

void turn_loop(const float* cosine, const float* sine, const float* phase, const float* weight, std::size_t count,
               Stretch& out) {
  const float* __restrict cosines = cosine, * __restrict sines = sine, * __restrict phases = phase;
  const float* __restrict weights = weight;
  float* __restrict base_c = out.cosine.data(), * __restrict base_s = out.sine.data();
  float* __restrict kept = out.weight.data();
  ENAMEL_INDEPENDENT
  for (std::size_t j = 0; j < count; ++j) {
    const float c = cosines[j], s = sines[j];
    const float inv2 = 1.0F / (c * c + s * s + 1e-6F);
    const float cos2 = (c - s) * (c + s) * inv2, sin2 = 2 * c * s * inv2;
    const float e = 4 * wrap_once(phases[j] - atan2_poly(s, c));
    const float cos4 = 2 * cos2 * cos2 - 1, sin4 = 2 * sin2 * cos2;
    // Turned by 2 atan(e/2), whose sine and cosine need no root: a vector longer than 1 would grow in its powers.
    const float half = 0.5F * e, inv = 1.0F / (1 + half * half), cos_e = (1 - half * half) * inv, sin_e = e * inv;
    const bool asked = weights[j] != 0;
    kept[j] = weights[j];
    base_c[j] = select(asked, cos_e * cos4 - sin_e * sin4, 0);
    base_s[j] = select(asked, cos_e * sin4 + sin_e * cos4, 0);
  }
}

/// A vector type of g++ and clang: left to themselves, they work on four lanes at a time.
using Lanes [[gnu::vector_size(4 * kMomentLanes)]] = float;

/// One pixel a lane; count: a multiple of the lanes.
void sum_loop(const Stretch& in, std::size_t count, MomentLanes& sums) {
  std::array<Lanes, kRippleTerms> cosines, sines;
  std::memcpy(&cosines, &sums.cosines, sizeof cosines);
  std::memcpy(&sines, &sums.sines, sizeof sines);
  for (std::size_t u = 0; u < count; u += kMomentLanes) {
    Lanes base_c, base_s, weight;
    std::memcpy(&base_c, &in.cosine[u], sizeof base_c);
    std::memcpy(&base_s, &in.sine[u], sizeof base_s);
    std::memcpy(&weight, &in.weight[u], sizeof weight);
    Lanes power_c = weight * base_c, power_s = weight * base_s;
    for (std::size_t m = 0; m < kRippleTerms; ++m) {
      cosines[m] += power_c;
      sines[m] += power_s;
      const Lanes next = power_c * base_c - power_s * base_s;
      power_s = power_s * base_c + power_c * base_s;
      power_c = next;
    }
  }
  std::memcpy(&sums.cosines, &cosines, sizeof cosines);
  std::memcpy(&sums.sines, &sines, sizeof sines);
}

void moments_loop(const PhaseMaps& m, const float* weight, std::size_t at, std::size_t width, MomentLanes& sums) {
  static_assert(kPolarStretch % kMomentLanes == 0);
  Stretch stretch;
  for (std::size_t from = 0; from < width; from += kPolarStretch) {
    const std::size_t count = std::min(kPolarStretch, width - from), i = at + from;
    const std::size_t whole = (count + kMomentLanes - 1) / kMomentLanes * kMomentLanes;
    turn_loop(&m.cosine_dn[i], &m.sine_dn[i], &m.phase_rad[i], weight + from, count, stretch);
    for (std::size_t j = count; j < whole; ++j) stretch.cosine[j] = stretch.sine[j] = stretch.weight[j] = 0;
    sum_loop(stretch, whole, sums);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(moments_loop);

void add_moments_row(const PhaseMaps& maps, const float* weight, std::size_t at, std::size_t width, MomentLanes& sums) {
  HWY_DYNAMIC_DISPATCH(moments_loop)(maps, weight, at, width, sums);
}

}  // namespace enamel::pipeline
#endif
