#include "pipeline/algo/phase/ripple_rows.hpp"

#include <algorithm>

#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/phase/ripple_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

struct Pixels {
  const float *cosine, *sine, *phase, *weight;
};

/// One pixel a lane; count <= kMomentLanes.
[[gnu::always_inline]] inline void add_pixels(const Pixels& p, std::size_t count, MomentLanes& sums) {
  std::array<float, kMomentLanes> base_c{}, base_s{}, power_c{}, power_s{};
  ENAMEL_INDEPENDENT
  for (std::size_t j = 0; j < count; ++j) {
    const float c = p.cosine[j], s = p.sine[j];
    const float inv2 = 1.0F / (c * c + s * s + 1e-6F);
    const float cos2 = (c - s) * (c + s) * inv2, sin2 = 2 * c * s * inv2;
    const float e = 4 * wrap_once(p.phase[j] - atan2_poly(s, c));
    const float cos4 = 2 * cos2 * cos2 - 1, sin4 = 2 * sin2 * cos2;
    const float w = p.weight[j];
    base_c[j] = select(w != 0, cos4 - e * sin4, 0);
    base_s[j] = select(w != 0, sin4 + e * cos4, 0);
    power_c[j] = w * base_c[j];
    power_s[j] = w * base_s[j];
  }
  for (std::size_t m = 0; m < kRippleTerms; ++m) {
    ENAMEL_INDEPENDENT
    for (std::size_t j = 0; j < kMomentLanes; ++j) {
      sums.cosines[m][j] += power_c[j];
      sums.sines[m][j] += power_s[j];
      const float next = power_c[j] * base_c[j] - power_s[j] * base_s[j];
      power_s[j] = power_s[j] * base_c[j] + power_c[j] * base_s[j];
      power_c[j] = next;
    }
  }
}

void moments_loop(const PhaseMaps& m, const float* weight, std::size_t at, std::size_t width, MomentLanes& sums) {
  MomentLanes local = sums;  // a copy cannot alias what is read
  for (std::size_t u = 0; u < width; u += kMomentLanes) {
    const Pixels pixels{&m.cosine_dn[at + u], &m.sine_dn[at + u], &m.phase_rad[at + u], weight + u};
    if (u + kMomentLanes <= width) {
      add_pixels(pixels, kMomentLanes, local);
    } else {
      add_pixels(pixels, width - u, local);
    }
  }
  sums = local;
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(moments_loop);

void add_moments_row(const PhaseMaps& maps, const float* weight, std::size_t at, std::size_t width, MomentLanes& sums) {
  HWY_DYNAMIC_DISPATCH(moments_loop)(maps, weight, at, width, sums);
}

}  // namespace enamel::algo
#endif
