#include "pipeline/algo/phase/micro_refit_rows.hpp"

#include <array>
#include <cmath>

#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/phase/micro_refit_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

constexpr float kHalfRoot3 = 0.8660254F, kInvRoot3 = 0.57735027F, kThird = 1.0F / 3;
constexpr float kFirstTime = -1.5F, kSecondTime = 0.5F, kThirdTime = 1.5F;
/// What motion and a common phase leave of phases that each of the three frames has for itself: at right angles to
/// both.
constexpr float kFirstSkew = 0.26726124F, kSecondSkew = -0.80178373F, kThirdSkew = 0.53452248F;
/// Variance of R over that of a frame: the code frame, A/3, and 2/3 each of the parts of B cos and B sin, on average.
constexpr float kResidualVariance = 2.1F;

struct Turn {
  float cos = 1, sin = 0;
};

/// |a| <= pi and a little: by the half angle, which the polynomials cover.
[[gnu::always_inline]] inline Turn turn_of(float a) {
  const float s = sin_poly(0.5F * a), c = cos_poly(0.5F * a);
  return {1 - 2 * s * s, 2 * s * c};
}

[[gnu::always_inline]] inline Turn operator*(Turn a, Turn b) {
  return {a.cos * b.cos - a.sin * b.sin, a.sin * b.cos + a.cos * b.sin};
}

struct Pixel {
  float mean = 0, cosine = 0, sine = 0;
};

/// Of one pixel, per frame interval: eps and its change, dA/A and d2A/A.
struct Change {
  float rate, rate_change, growth, growth_change;

  [[nodiscard, gnu::always_inline]] float light(float t) const { return 1 + t * growth + 0.5F * t * t * growth_change; }
  [[nodiscard, gnu::always_inline]] float turned(float t) const { return t * rate + 0.5F * t * t * rate_change; }
};

/// The three-frame solution, above black, with each frame at its own time and under its own light.
[[gnu::always_inline]] inline Pixel at_mid_burst(const Pixel& p, const Change& d) {
  const float half = p.mean - 0.5F * p.cosine;
  const float i0 = (p.mean + p.cosine) / d.light(kFirstTime);
  const float i2 = (half - kHalfRoot3 * p.sine) / d.light(kSecondTime);
  const float i3 = (half + kHalfRoot3 * p.sine) / d.light(kThirdTime);
  const Turn a0 = turn_of(d.turned(kFirstTime));
  const Turn a1 = Turn{-0.5F, kHalfRoot3} * turn_of(d.turned(kSecondTime));
  const Turn a2 = Turn{-0.5F, -kHalfRoot3} * turn_of(d.turned(kThirdTime));
  const float c1 = a0.cos - a1.cos, s1 = a1.sin - a0.sin, c2 = a0.cos - a2.cos, s2 = a2.sin - a0.sin;
  const float inverse = 1 / (c1 * s2 - s1 * c2);  // sqrt(27)/2 at rest, positive for any motion below a radian
  const float c = ((i0 - i2) * s2 - s1 * (i0 - i3)) * inverse, s = (c1 * (i0 - i3) - (i0 - i2) * c2) * inverse;
  return {i0 - c * a0.cos + s * a0.sin, c, s};
}

/// The code frame's model about a phase within its turn: cos and sin of r (Phi + turned), with the second harmonic
/// B2/B of the projector, which also beats with three steps.
struct CodeModel {
  Turn angle;
  float light = 0;       ///< over g B
  float modulation = 1;  ///< B of the fundamental over that of the three-frame solution
};

[[gnu::always_inline]] inline CodeModel code_model(Turn order, float inverse_ratio, float phase_rad, float turned_rad,
                                                   float harmonic) {
  const Turn once = turn_of(phase_rad);
  const float moved = (1 + inverse_ratio) * turned_rad;
  const Turn a = once * turn_of(phase_rad * inverse_ratio + moved) * order;
  const float cos3 = once.cos * (4 * once.cos * once.cos - 3);
  return {a, a.cos + harmonic * (2 * a.cos * a.cos - 1), 1 - harmonic * cos3};
}

/// What the code frame shows beyond the prediction of the other three, about the motion and gain assumed, and its slope
/// over each of them. In DN; light: of dA/A; alone: of a phase that the code frame has for itself; skew: see kSkew.
struct Residual {
  float rest, by_motion, by_light, by_gain, by_alone, by_skew, modulation;
};

/// raw: above black; code: I_1 - A; phase_rad: of `raw`, with its order.
[[gnu::always_inline]] inline Residual code_residual(const Pixel& raw, float code, float phase_rad, Turn order,
                                                     const Change& d, float gain, float inverse_ratio, float harmonic) {
  const Pixel p = at_mid_burst(raw, d);
  const float b3 = root(p.cosine * p.cosine + p.sine * p.sine + 1e-6F), c = p.cosine / b3, s = p.sine / b3;
  const float moved = phase_rad + wrap_once(atan2_poly(p.sine, p.cosine) - atan2_poly(raw.sine, raw.cosine));
  const CodeModel k = code_model(order, inverse_ratio, moved, d.turned(kCodeTime), harmonic);
  const float b = b3 * k.modulation, gb = gain * b;
  // What frames that differ by f0, f2, f3 (over B) take from A, B cos and B sin, and that from the prediction.
  const auto slope = [&](float f0, float f2, float f3, float turned) {
    const float da = -kThird * (f0 + f2 + f3), dc = -kThird * (2 * f0 - f2 - f3), ds = -kInvRoot3 * (f3 - f2);
    const float turning = c * ds - s * dc, swelling = c * dc + s * ds;
    return -b * da - gb * swelling * k.angle.cos + gb * (1 + inverse_ratio) * k.angle.sin * (turning + turned);
  };
  const float c2 = -0.5F * c - kHalfRoot3 * s, c3 = -0.5F * c + kHalfRoot3 * s;  // cos of the other two frames
  const float s2 = -0.5F * s + kHalfRoot3 * c, s3 = -0.5F * s - kHalfRoot3 * c;
  const float part = p.mean / b;  // A/B
  const float by_motion = slope(-kFirstTime * s, -kSecondTime * s2, -kThirdTime * s3, kCodeTime);
  const float by_light = slope(kFirstTime * (part + c), kSecondTime * (part + c2), kThirdTime * (part + c3), 0) -
                         kCodeTime * (p.mean + gb * k.angle.cos);
  const float code_frame = (raw.mean + code) / d.light(kCodeTime);
  return {code_frame - p.mean - gb * k.light,
          by_motion,
          by_light,
          -b * k.light,
          gb * (1 + inverse_ratio) * k.angle.sin,
          slope(-kFirstSkew * s, -kSecondSkew * s2, -kThirdSkew * s3, 0),
          b};
}

void add_loop(const PhaseMaps& m, const CodeRow& row, const NoiseModel& model, float limit, std::size_t at,
              std::size_t width, float* sums) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const float inverse_ratio = row.inverse_ratio, harmonic = row.harmonic, black = row.black_dn;
  const float* __restrict mean = &m.mean_dn[at], * __restrict cosine = &m.cosine_dn[at], * __restrict sine = &m.sine_dn[at];
  const float* __restrict code = &m.code_dn[at], * __restrict phase = &m.phase_rad[at];
  const float* __restrict rate = row.motion_rad, * __restrict gain = row.gain, * __restrict light = row.light;
  const float* __restrict oc = row.order_cos, * __restrict os = row.order_sin;
  float* __restrict s0 = sums, * __restrict s1 = s0 + width, * __restrict s2 = s1 + width;
  float* __restrict s3 = s2 + width, * __restrict s4 = s3 + width;
  const float* __restrict rate_change = row.motion_change_rad, * __restrict growth_change = row.light_change;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const Change d{rate[u], rate_change[u], light[u], growth_change[u]};
    const Residual k = code_residual({mean[u] - black, cosine[u], sine[u]}, code[u], phase[u], {oc[u], os[u]}, d,
                                     gain[u], inverse_ratio, harmonic);
    const bool used =
        (std::abs(k.rest) < limit * k.modulation) & (oc[u] * oc[u] + os[u] * os[u] > 0.5F);  // false for NaN
    const float w = select(used, 1 / (kResidualVariance * noise.variance(mean[u])), 0), r = select(used, k.rest, 0);
    s0[u] += w * k.by_gain * k.by_gain;
    s1[u] += w * k.by_gain * k.by_motion;
    s2[u] += w * k.by_motion * k.by_motion;
    s3[u] += w * k.by_gain * r;
    s4[u] += w * k.by_motion * r;
  }
}

void residual_loop(const PhaseMaps& m, const CodeRow& row, std::size_t at, std::size_t width, const ResidualRow& out) {
  const float inverse_ratio = row.inverse_ratio, harmonic = row.harmonic, black = row.black_dn;
  const float* __restrict mean = &m.mean_dn[at], * __restrict cosine = &m.cosine_dn[at], * __restrict sine = &m.sine_dn[at];
  const float* __restrict code = &m.code_dn[at], * __restrict phase = &m.phase_rad[at];
  const float* __restrict rate = row.motion_rad, * __restrict gain = row.gain, * __restrict lit = row.light;
  const float* __restrict oc = row.order_cos, * __restrict os = row.order_sin;
  float* __restrict rest = out.residual, * __restrict motion = out.by_motion;
  float* __restrict light = out.by_light, * __restrict growth = out.by_gain;
  const float* __restrict rate_change = row.motion_change_rad, * __restrict growth_change = row.light_change;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const Change d{rate[u], rate_change[u], lit[u], growth_change[u]};
    const Residual k = code_residual({mean[u] - black, cosine[u], sine[u]}, code[u], phase[u], {oc[u], os[u]}, d,
                                     gain[u], inverse_ratio, harmonic);
    rest[u] = k.rest;
    motion[u] = -k.by_motion;
    light[u] = -k.by_light;
    growth[u] = -k.by_gain;
  }
}

void odd_loop(const PhaseMaps& m, const CodeRow& row, const NoiseModel& model, float limit, std::size_t at,
              std::size_t width, float* sums) {
  const NoiseModel noise = model;
  const float inverse_ratio = row.inverse_ratio, harmonic = row.harmonic, black = row.black_dn;
  const float* __restrict mean = &m.mean_dn[at], * __restrict cosine = &m.cosine_dn[at], * __restrict sine = &m.sine_dn[at];
  const float* __restrict code = &m.code_dn[at], * __restrict phase = &m.phase_rad[at];
  const float* __restrict rate = row.motion_rad, * __restrict gain = row.gain, * __restrict light = row.light;
  const float* __restrict oc = row.order_cos, * __restrict os = row.order_sin;
  float* __restrict out = sums;
  const float* __restrict rate_change = row.motion_change_rad, * __restrict growth_change = row.light_change;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const Pixel raw{mean[u] - black, cosine[u], sine[u]};
    const Change d{rate[u], rate_change[u], light[u], growth_change[u]};
    const Residual k = code_residual(raw, code[u], phase[u], {oc[u], os[u]}, d, gain[u], inverse_ratio, harmonic);
    const bool asked = (k.rest == k.rest) & (oc[u] * oc[u] + os[u] * os[u] > 0.5F);
    const bool used = (std::abs(k.rest) < limit * k.modulation) & asked;
    const float w = select(used, 1 / (kResidualVariance * noise.variance(mean[u])), 0), y = select(used, -k.rest, 0);
    const std::array<float, kOddColumns> x = {k.by_alone, k.by_skew, k.by_motion, k.by_light, k.by_gain};
    std::size_t to = u;
    for (std::size_t i = 0; i < kOddColumns; ++i) {
      for (std::size_t j = i; j < kOddColumns; ++j, to += width) out[to] += w * x[i] * x[j];
      out[to] += w * x[i] * y;
      to += width;
    }
    out[to] += select(asked, 1, 0);
    out[to + width] += select(used, 1, 0);
  }
}

void mid_burst_loop(const PhaseMaps& m, const CodeRow& row, std::size_t at, std::size_t width, float* phase_rad,
                    float* mean_dn) {
  const float black = row.black_dn;
  const float* __restrict mean = &m.mean_dn[at], * __restrict cosine = &m.cosine_dn[at], * __restrict sine = &m.sine_dn[at];
  const float* __restrict phase = &m.phase_rad[at], * __restrict rate = row.motion_rad, * __restrict light = row.light;
  float* __restrict moved = phase_rad, * __restrict lit = mean_dn;
  const float* __restrict rate_change = row.motion_change_rad, * __restrict growth_change = row.light_change;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const Pixel raw{mean[u] - black, cosine[u], sine[u]};
    const Pixel p = at_mid_burst(raw, {rate[u], rate_change[u], light[u], growth_change[u]});
    moved[u] = phase[u] + wrap_once(atan2_poly(p.sine, p.cosine) - atan2_poly(raw.sine, raw.cosine));
    lit[u] = p.mean + black;
  }
}

void undo_loop(const CodeRow& row, std::size_t at, std::size_t width, PhaseMaps& m) {
  const float black = row.black_dn;
  float* __restrict mean = &m.mean_dn[at], * __restrict cosine = &m.cosine_dn[at], * __restrict sine = &m.sine_dn[at];
  float* __restrict code = &m.code_dn[at], * __restrict modulation = &m.modulation_dn[at], * __restrict phase = &m.phase_rad[at];
  const float* __restrict rate = row.motion_rad, * __restrict light = row.light;
  const float* __restrict oc = row.order_cos, * __restrict os = row.order_sin;
  const float* __restrict rate_change = row.motion_change_rad, * __restrict growth_change = row.light_change;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const bool inside = oc[u] * oc[u] + os[u] * os[u] > 0.5F;
    const Pixel raw{mean[u] - black, cosine[u], sine[u]};
    const Change d{rate[u], rate_change[u], light[u], growth_change[u]};
    const Pixel p = at_mid_burst(raw, d);
    const float step = wrap_once(atan2_poly(p.sine, p.cosine) - atan2_poly(raw.sine, raw.cosine));
    phase[u] += select(inside, step, 0);
    code[u] = select(inside, (raw.mean + code[u]) / d.light(kCodeTime) - p.mean, code[u]);
    mean[u] = select(inside, p.mean + black, mean[u]);
    cosine[u] = select(inside, p.cosine, raw.cosine);
    sine[u] = select(inside, p.sine, raw.sine);
    modulation[u] = select(inside, root(p.cosine * p.cosine + p.sine * p.sine + 1e-6F), modulation[u]);
  }
}

void join_loop(const CodeRow& row, const NoiseModel& model, float outlier_sigmas, std::size_t at, std::size_t width,
               PhaseMaps& m, float* missed) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const float inverse_ratio = row.inverse_ratio, r = 1 + inverse_ratio, harmonic = row.harmonic;
  const float gate = outlier_sigmas * outlier_sigmas;
  const float* __restrict rate = row.motion_rad, * __restrict gain = row.gain;
  const float* __restrict oc = row.order_cos, * __restrict os = row.order_sin;
  const float* __restrict mean = &m.mean_dn[at], * __restrict d = &m.code_dn[at], * __restrict modulation = &m.modulation_dn[at];
  float* __restrict phase = &m.phase_rad[at], * __restrict sigma = &m.sigma_rad[at];
  float* __restrict squares = missed;
  const float* __restrict rate_change = row.motion_change_rad;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float turned = kCodeTime * rate[u] + 0.5F * kCodeTime * kCodeTime * rate_change[u];
    const CodeModel k = code_model({oc[u], os[u]}, inverse_ratio, phase[u], turned, harmonic);
    const float gb = gain[u] * modulation[u] * k.modulation, off = d[u] - gb * k.light, slope = -gb * r * k.angle.sin;
    // The code frame's own noise, and that of A and B in what it is compared with.
    const float fitted = gain[u] * k.angle.cos;
    const float own =
        noise.variance(mean[u] + gb * k.light) + noise.variance(mean[u]) * kThird * (1 + 2 * fitted * fitted);
    const float variance = sigma[u] * sigma[u], total = own + slope * slope * variance;
    const bool inside = oc[u] * oc[u] + os[u] * os[u] > 0.5F;
    const bool joins = (off * off < gate * total) & inside;  // false for NaN
    squares[u] = select(inside, off * off / total, 0);
    const float share = select(joins, variance * slope / total, 0);
    phase[u] += share * select(joins, off, 0);
    sigma[u] = root(variance * (1 - share * slope));
  }
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(add_loop);
HWY_EXPORT(residual_loop);
HWY_EXPORT(odd_loop);
HWY_EXPORT(mid_burst_loop);
HWY_EXPORT(undo_loop);
HWY_EXPORT(join_loop);

void add_refit_row(const PhaseMaps& maps, const CodeRow& row, const NoiseModel& noise, float max_residual,
                   std::size_t at, std::size_t width, float* sums) {
  HWY_DYNAMIC_DISPATCH(add_loop)(maps, row, noise, max_residual, at, width, sums);
}

void code_residual_row(const PhaseMaps& maps, const CodeRow& row, std::size_t at, std::size_t width,
                       const ResidualRow& out) {
  HWY_DYNAMIC_DISPATCH(residual_loop)(maps, row, at, width, out);
}

void add_micro_odd_row(const PhaseMaps& maps, const CodeRow& row, const NoiseModel& noise, float max_residual,
                       std::size_t at, std::size_t width, float* sums) {
  HWY_DYNAMIC_DISPATCH(odd_loop)(maps, row, noise, max_residual, at, width, sums);
}

void mid_burst_row(const PhaseMaps& maps, const CodeRow& row, std::size_t at, std::size_t width, float* phase_rad,
                   float* mean_dn) {
  HWY_DYNAMIC_DISPATCH(mid_burst_loop)(maps, row, at, width, phase_rad, mean_dn);
}

void undo_motion_row(const CodeRow& row, std::size_t at, std::size_t width, PhaseMaps& maps) {
  HWY_DYNAMIC_DISPATCH(undo_loop)(row, at, width, maps);
}

void join_code_row(const CodeRow& row, const NoiseModel& noise, float outlier_sigmas, std::size_t at, std::size_t width,
                   PhaseMaps& maps, float* missed) {
  HWY_DYNAMIC_DISPATCH(join_loop)(row, noise, outlier_sigmas, at, width, maps, missed);
}

}  // namespace enamel::algo
#endif
