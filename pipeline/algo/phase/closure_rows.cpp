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

/// Of one pixel, per frame interval: eps and its change, dA/A and d2A/A.
struct Change {
  float rate, rate_change, growth, growth_change;

  [[nodiscard, gnu::always_inline]] float light(float t) const { return 1 + t * growth + 0.5F * t * t * growth_change; }
};

/// Values of the four frames, those of a pixel above black under the light of mid-burst.
struct Frames {
  float x0, x1, x2, x3;
};

[[gnu::always_inline]] inline Frames frames_of(const Pixel& p, float residual, float weight, const Change& d) {
  const float b = select(weight < 0, -1, 1), r = select(residual == residual, residual, 0);
  const float three = p.sine + 0.5F * std::abs(weight) * r;  // S of three frames; less the residual that of frame 3
  return {(p.mean + p.cosine) / d.light(-1.5F), (p.mean - three) / d.light(-0.5F), (p.mean - p.cosine) / d.light(0.5F),
          (p.mean + b * (three - r)) / d.light(1.5F)};
}

struct Turn {
  float cos, sin;
};

/// What each frame's phase differs by from mid-burst.
struct Turns {
  Turn a0, a1, a2, a3;
};

[[gnu::always_inline]] inline Turns turns_of(const Change& d) {
  const auto turn = [&](float t) {
    const float a = t * d.rate + 0.5F * t * t * d.rate_change;
    return Turn{cos_poly(a), sin_poly(a)};
  };
  return {turn(-1.5F), turn(-0.5F), turn(0.5F), turn(1.5F)};
}

/// A, C and S at mid-burst, exactly, by the equations of the frames used, each at its own time:
///   x0 = A + C cos a0 - S sin a0      x1 = A - S cos a1 - C sin a1
///   x2 = A - C cos a2 + S sin a2      x3 = A + b (S cos a3 + C sin a3)
/// Frames 1 and 3 enter as one, (1 - q)(A - x1) + q b (x3 - A) with q = w/2, so that noise counts as in polarity.hpp.
[[gnu::always_inline]] inline Pixel solve(const Frames& x, float weight, const Turns& t) {
  const float q = 0.5F * std::abs(weight), b = select(weight < 0, -1, 1), of_mean = 0.5F * (1 - q - q * b);
  const float even_c = t.a0.cos + t.a2.cos, even_s = -t.a0.sin - t.a2.sin, even = x.x0 - x.x2;
  const float odd_c = (1 - q) * t.a1.sin + q * t.a3.sin + of_mean * (t.a0.cos - t.a2.cos);
  const float odd_s = (1 - q) * t.a1.cos + q * t.a3.cos - of_mean * (t.a0.sin - t.a2.sin);
  const float odd = of_mean * (x.x0 + x.x2) - (1 - q) * x.x1 + q * b * x.x3;
  const float inverse = 1 / (even_c * odd_s - even_s * odd_c);  // 1/2 at rest, positive for any motion below 0.5 rad
  const float c = (even * odd_s - even_s * odd) * inverse, s = (even_c * odd - even * odd_c) * inverse;
  return {0.5F * (x.x0 + x.x2 - c * (t.a0.cos - t.a2.cos) + s * (t.a0.sin - t.a2.sin)), c, s};
}

/// What the frames of `p` show of a second harmonic, per B2/B.
[[gnu::always_inline]] inline Frames harmonic_of(const Pixel& p, const Turns& t) {
  const float inv = 1 / root(p.cosine * p.cosine + p.sine * p.sine + 1e-6F);
  const float cos2 = (p.cosine - p.sine) * (p.cosine + p.sine) * inv, sin2 = 2 * p.cosine * p.sine * inv;
  const auto at = [&](const Turn& a) { return cos2 * (1 - 2 * a.sin * a.sin) - sin2 * 2 * a.sin * a.cos; };
  return {at(t.a0), -at(t.a1), at(t.a2), -at(t.a3)};
}

void mid_burst_loop(const PhaseMaps& m, const RowErrors& e, std::size_t at, std::size_t width, float* phase,
                    float* light) {
  const float* __restrict c = &m.cosine_dn[at], * __restrict s = &m.sine_dn[at], * __restrict r = &m.code_dn[at];
  const float* __restrict mean = &m.mean_dn[at], * __restrict w = e.weight, * __restrict rate = e.rate;
  const float* __restrict rho = e.harmonic, * __restrict growth = e.light;
  const float* __restrict rate_change = e.rate_change, * __restrict growth_change = e.light_change;
  const float* measured = &m.phase_rad[at];  // which `phase` may be
  const float black_dn = e.black_dn;
  float* out = phase;
  float* __restrict lit = light;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const Change d{rate[u], rate_change[u], growth[u], growth_change[u]};
    const Turns turns = turns_of(d);
    const Pixel p = solve(frames_of({mean[u] - black_dn, c[u], s[u]}, r[u], w[u], d), w[u], turns);
    const Pixel h = solve(harmonic_of(p, turns), w[u], turns);
    const float cosine = p.cosine - rho[u] * h.cosine, sine = p.sine - rho[u] * h.sine;
    out[u] = measured[u] + atan2_poly(sine * c[u] - cosine * s[u], cosine * c[u] + sine * s[u]);
    lit[u] = p.mean - rho[u] * h.mean;
  }
}

void left_loop(const PhaseMaps& m, const RowErrors& e, std::size_t at, std::size_t width, const LeftRow& row) {
  const float* __restrict c = &m.cosine_dn[at], * __restrict s = &m.sine_dn[at], * __restrict r = &m.code_dn[at];
  const float* __restrict mean = &m.mean_dn[at], * __restrict w = e.weight, * __restrict rate = e.rate;
  const float* __restrict growth = e.light;
  const float* __restrict rate_change = e.rate_change, * __restrict growth_change = e.light_change;
  const float black_dn = e.black_dn;
  float* __restrict left = row.residual, * __restrict by_rate = row.by_rate;
  float* __restrict by_light = row.by_light, * __restrict by_harmonic = row.by_harmonic;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const Change d{rate[u], rate_change[u], growth[u], growth_change[u]};
    const Turns turns = turns_of(d);
    const Frames x = frames_of({mean[u] - black_dn, c[u], s[u]}, r[u], w[u], d);
    const Pixel p = solve(x, w[u], turns);
    const float b = select(w[u] < 0, -1, 1);
    const auto unexplained = [&](const Frames& f) {
      const Pixel three = solve(f, 0, turns);
      return d.light(1.5F) * (b * (three.mean - f.x3) + three.sine * turns.a3.cos + three.cosine * turns.a3.sin);
    };
    const bool plus = w[u] > 0;
    left[u] = select((std::abs(w[u]) > 0.999F) & (r[u] == r[u]), unexplained(x), kNone);
    by_rate[u] = 2 * (select(plus, p.sine, 0) - p.cosine);
    by_light[u] = select(plus, -2 * (p.mean + p.cosine + p.sine), 2 * (p.mean - p.sine));
    by_harmonic[u] = unexplained(harmonic_of(p, turns));
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
