#include "pipeline/algo/phase/closure_rows.hpp"

#include <cmath>
#include <limits>

#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/phase/closure_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

void add_loop(const PhaseMaps& m, const PolarityMaps& p, std::size_t at, std::size_t width, float limit, float* sums) {
  const float* __restrict c = &m.cosine_dn[at], * __restrict s = &m.sine_dn[at], * __restrict b = &m.modulation_dn[at];
  const float* __restrict r = &m.code_dn[at], * __restrict w = &p.weight[at];
  float* __restrict s0 = sums, * __restrict s1 = s0 + width, * __restrict s2 = s1 + width;
  float* __restrict s3 = s2 + width, * __restrict s4 = s3 + width, * __restrict s5 = s4 + width;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float used = select(std::abs(w[u]) > 0.999F, 1, 0) * select(std::abs(r[u]) < limit * b[u], 1, 0);
    const float plus = select(w[u] > 0, used, 0);
    const float x1 = 2 * (s[u] * plus - c[u] * used);
    const float x2 = 4 * plus * (c[u] - s[u]) * (c[u] + s[u]) / (b[u] + 1e-6F);
    const float y = select(used > 0, r[u], 0);
    s0[u] += x1 * x1;
    s1[u] += x1 * x2;
    s2[u] += x2 * x2;
    s3[u] += x1 * y;
    s4[u] += x2 * y;
    s5[u] += used;
  }
}

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// A pixel above black, or what is left of it at mid-burst.
struct Pixel {
  float mean, cosine, sine;
};

/// A, C and S at mid-burst: the equations of the frames used, each at its own time and under its own light, solved
/// exactly. x: I / light above black, q = w/2, h = eps/2, c3 s3 of 3h:
///   x0 = A + C c3 + S s3     x1 = A - S c + C s     x2 = A - C c + S s     x3 = A + b (S c3 + C s3)
/// Frames 1 and 3 enter as one equation, (1 - q)(A - x1) + q b (x3 - A), so that noise counts as in polarity.hpp.
[[gnu::always_inline]] inline Pixel at_mid_burst(const Pixel& p, float residual, float weight, float rate,
                                                 float growth) {
  const float q = 0.5F * std::abs(weight), b = select(weight < 0, -1, 1);
  const float r = select(residual == residual, residual, 0), three = p.sine + q * r;
  const float x0 = (p.mean + p.cosine) / (1 - 1.5F * growth), x1 = (p.mean - three) / (1 - 0.5F * growth);
  const float x2 = (p.mean - p.cosine) / (1 + 0.5F * growth), x3 = (p.mean + b * (three - r)) / (1 + 1.5F * growth);
  const float c = cos_poly(0.5F * rate), s = sin_poly(0.5F * rate), c3 = c * (4 * c * c - 3), s3 = s * (3 - 4 * s * s);
  const float of_mean = 0.5F * (1 - q - q * b);
  const float c_even = c3 + c, s_even = s3 - s, even = x0 - x2;
  const float c_odd = q * s3 - (1 - q) * s + of_mean * (c3 - c), s_odd = q * c3 + (1 - q) * c + of_mean * (s3 + s);
  const float odd = of_mean * (x0 + x2) - (1 - q) * x1 + q * b * x3;
  const float inverse = 1 / (c_even * s_odd - s_even * c_odd);  // 1/2 at rest, positive for any motion below half a radian
  const float cosine = (even * s_odd - s_even * odd) * inverse, sine = (c_even * odd - even * c_odd) * inverse;
  return {0.5F * (x0 + x2 - cosine * (c3 - c) - sine * (s3 + s)), cosine, sine};
}

void mid_burst_loop(const PhaseMaps& m, const RowErrors& e, std::size_t at, std::size_t width, float* phase,
                    float* light) {
  const float* __restrict c = &m.cosine_dn[at], * __restrict s = &m.sine_dn[at], * __restrict r = &m.code_dn[at];
  const float* __restrict mean = &m.mean_dn[at], * __restrict w = e.weight, * __restrict rate = e.rate;
  const float* __restrict rho = e.harmonic, * __restrict growth = e.light;
  const float* measured = &m.phase_rad[at];  // which `phase` may be
  const float black_dn = e.black_dn;
  float* out = phase;
  float* __restrict lit = light;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const Pixel p = at_mid_burst({mean[u] - black_dn, c[u], s[u]}, r[u], w[u], rate[u], growth[u]);
    const float inv = 1 / root(p.cosine * p.cosine + p.sine * p.sine + 1e-6F);
    const float cos2 = (p.cosine - p.sine) * (p.cosine + p.sine) * inv;  // B cos 2phi
    const float ripple = 2 * rho[u] * cos2 * p.cosine * inv * inv * (1 - larger(w[u], 0));
    const float turned = atan2_poly(p.sine * c[u] - p.cosine * s[u], p.cosine * c[u] + p.sine * s[u]);
    out[u] = measured[u] + turned - ripple;
    lit[u] = p.mean - rho[u] * cos2;
  }
}

void left_loop(const PhaseMaps& m, const RowErrors& e, std::size_t at, std::size_t width, const LeftRow& row) {
  const float* __restrict c = &m.cosine_dn[at], * __restrict s = &m.sine_dn[at], * __restrict r = &m.code_dn[at];
  const float* __restrict mean = &m.mean_dn[at], * __restrict w = e.weight, * __restrict rate = e.rate;
  const float* __restrict growth = e.light;
  const float black_dn = e.black_dn;
  float* __restrict left = row.residual, * __restrict by_rate = row.by_rate;
  float* __restrict by_light = row.by_light, * __restrict by_harmonic = row.by_harmonic;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const Pixel raw{mean[u] - black_dn, c[u], s[u]};
    const Pixel three = at_mid_burst({raw.mean, raw.cosine, raw.sine + 0.5F * r[u]}, r[u], 0, rate[u], growth[u]);
    const Pixel p = at_mid_burst(raw, r[u], w[u], rate[u], growth[u]);
    const float b = select(w[u] < 0, -1, 1), a = 1.5F * rate[u];
    const float wave = three.sine * cos_poly(a) + three.cosine * sin_poly(a);
    const float seen = b * raw.mean + raw.sine - 0.5F * r[u];  // b (I3 - black)
    const bool plus = w[u] > 0;
    left[u] = select(std::abs(w[u]) > 0.999F, (1 + 1.5F * growth[u]) * (b * three.mean + wave) - seen, kNone);
    by_rate[u] = 2 * (select(plus, p.sine, 0) - p.cosine);
    by_light[u] = select(plus, -2 * (p.mean + p.cosine + p.sine), 2 * (p.mean - p.sine));
    by_harmonic[u] = select(plus, 4, 0) * (p.cosine - p.sine) * (p.cosine + p.sine) /
                     root(p.cosine * p.cosine + p.sine * p.sine + 1e-6F);
  }
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(add_loop);
HWY_EXPORT(mid_burst_loop);
HWY_EXPORT(left_loop);

void add_closure_row(const PhaseMaps& m, const PolarityMaps& p, std::size_t at, std::size_t width, float limit,
                     float* sums) {
  HWY_DYNAMIC_DISPATCH(add_loop)(m, p, at, width, limit, sums);
}

void mid_burst_row(const PhaseMaps& m, const RowErrors& e, std::size_t at, std::size_t width, float* phase_rad,
                   float* light_dn) {
  HWY_DYNAMIC_DISPATCH(mid_burst_loop)(m, e, at, width, phase_rad, light_dn);
}

void left_row(const PhaseMaps& m, const RowErrors& e, std::size_t at, std::size_t width, const LeftRow& out) {
  HWY_DYNAMIC_DISPATCH(left_loop)(m, e, at, width, out);
}

}  // namespace enamel::algo
#endif
