#include "pipeline/decode/mode_t/ripple_depth_rows.hpp"

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_t/ripple_depth_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void depth_loop(const DepthRippleTerms& terms, const std::int16_t* turns, const float* mid_rad, std::size_t at,
                std::size_t width, PhaseMaps& m) {
  const DepthRippleTerms t = terms;  // a copy cannot alias what is written
  const float* __restrict cosine = &m.cosine_dn[at], * __restrict sine = &m.sine_dn[at], * __restrict mid = mid_rad;
  const std::int16_t* __restrict wraps = turns;
  const PixelReject* __restrict reject = &m.reject[at];
  float* __restrict phase = &m.phase_rad[at];
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float x = phase[u] + kTwoPiF * static_cast<float>(wraps[u]) - mid[u] - t.mean;
    const float d = larger(-t.reach, smaller(t.reach, x));
    const float c = cosine[u], s = sine[u], inv2 = 1.0F / (c * c + s * s + 1e-6F);
    const float cos2 = (c - s) * (c + s) * inv2, sin2 = 2 * c * s * inv2;
    const float cos4 = 2 * cos2 * cos2 - 1, sin4 = 2 * sin2 * cos2;
    float of_cos = cos4, of_sin = sin4, error = 0;
    for (std::size_t k = 0; k < kRippleTerms; ++k) {
      const auto &a = t.cosine[k], &b = t.sine[k];
      error += (a[0] + d * (a[1] + d * a[2])) * of_cos + (b[0] + d * (b[1] + d * b[2])) * of_sin;
      const float next = of_cos * cos4 - of_sin * sin4;
      of_sin = of_sin * cos4 + of_cos * sin4;
      of_cos = next;
    }
    phase[u] -= select(reject[u] == PixelReject::kNone, error, 0);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(depth_loop);

DepthRippleTerms float_terms(const DepthRipple& ripple) {
  const DepthPolynomials& p = ripple.depth;
  DepthRippleTerms out{
      .mean = static_cast<float>(p.mean), .reach = static_cast<float>(p.reach), .cosine = {}, .sine = {}};
  const auto powers = [&](double first, double second) {
    return DepthRippleTerms::Powers{static_cast<float>(-second * p.scale * p.level),
                                    static_cast<float>(first * p.per_d - second * p.scale * p.tilt),
                                    static_cast<float>(second * p.scale)};
  };
  for (std::size_t m = 0; m < kRippleTerms; ++m) {
    out.cosine[m] = powers(ripple.of[0].cosine[m], ripple.of[1].cosine[m]);
    out.sine[m] = powers(ripple.of[0].sine[m], ripple.of[1].sine[m]);
  }
  return out;
}

void correct_by_depth_row(const DepthRippleTerms& terms, const Map<std::int16_t>& wraps, const float* phase_mid_rad,
                          std::size_t at, std::size_t width, PhaseMaps& maps) {
  HWY_DYNAMIC_DISPATCH(depth_loop)(terms, &wraps[at], phase_mid_rad + at, at, width, maps);
}

}  // namespace enamel::pipeline
#endif
