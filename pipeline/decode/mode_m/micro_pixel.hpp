// One pixel of a mode M burst: its three phase frames at mid-burst, and what its code frame shows beside them
// (equations in micro_refit.hpp). For loops over rows, compiled into each. Private to pipeline/decode.
#pragma once

#include "pipeline/decode/phase/frame_turns.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {

/// layout: weights of three frames; frame intervals after mid-burst.
inline constexpr float kHalfRoot3 = 0.8660254F, kInvRoot3 = 0.57735027F, kThird = 1.0F / 3;
inline constexpr float kFirstTime = -1.5F, kSecondTime = 0.5F, kThirdTime = 1.5F;
/// What motion and a common phase leave of phases that each of the three frames has for itself: at right angles to
/// both. derived: (1, -3, 2)/sqrt(14).
inline constexpr float kFirstSkew = 0.26726124F, kSecondSkew = -0.80178373F, kThirdSkew = 0.53452248F;
inline constexpr Turn kThirdTurn{-0.5F, kHalfRoot3};  ///< layout: by 2 pi/3

/// A pixel above black.
struct Pixel {
  float mean, cosine, sine;
};

/// What each frame is multiplied by to have the light of mid-burst.
struct Lights {
  float of_first = 1, of_code = 1, of_second = 1, of_third = 1;
};

/// kSteady: light stays as it is.
template <bool kSteady>
[[gnu::always_inline]] inline Lights lights_of(const PixelChange& d) {
  if constexpr (kSteady) return {};
  const float l0 = d.light(kFirstTime), l1 = d.light(kCodeTime), l2 = d.light(kSecondTime), l3 = d.light(kThirdTime);
  const float early = l0 * l1, late = l2 * l3, inverse = 1 / (early * late);  // one division for four
  const float of_early = inverse * late, of_late = inverse * early;
  return {of_early * l1, of_early * l0, of_late * l3, of_late * l2};
}

/// The three-frame solution with each frame at its own time and under its own light.
[[gnu::always_inline]] inline Pixel at_mid_burst(const Pixel& p, const Lights& light, const Turns& t) {
  const float half = p.mean - 0.5F * p.cosine;
  const float i0 = (p.mean + p.cosine) * light.of_first;
  const float i2 = (half - kHalfRoot3 * p.sine) * light.of_second;
  const float i3 = (half + kHalfRoot3 * p.sine) * light.of_third;
  const Turn a0 = t.a0, a1 = kThirdTurn + t.a2, a2 = -kThirdTurn + t.a3;
  const float c1 = a0.cos - a1.cos, s1 = a1.sin - a0.sin, c2 = a0.cos - a2.cos, s2 = a2.sin - a0.sin;
  const float inverse = 1 / (c1 * s2 - s1 * c2);  // sqrt(27)/2 at rest, positive for any motion below a radian
  const float c = ((i0 - i2) * s2 - s1 * (i0 - i3)) * inverse, s = (c1 * (i0 - i3) - (i0 - i2) * c2) * inverse;
  return {i0 - c * a0.cos + s * a0.sin, c, s};
}

/// By how much the phase of `to` is ahead of that of `from`.
[[gnu::always_inline]] inline float ahead(const Pixel& from, const Pixel& to) {
  return atan2_poly(to.sine * from.cosine - to.cosine * from.sine, to.cosine * from.cosine + to.sine * from.sine);
}

/// What is the same for all pixels of a row.
struct CodeWave {
  float inverse_ratio, harmonic;
};

/// The code frame's model about a phase and its wrap count: cos and sin of r Phi + moved, with the second harmonic B2/B
/// of the projector, which also beats with three steps.
struct CodeModel {
  Turn angle;
  float light;       ///< over g B
  float modulation;  ///< B of the fundamental over that of the three-frame solution
};

/// cos 2x and cos 3x of cos x.
[[gnu::always_inline]] inline float twice(float cosine) { return 2 * cosine * cosine - 1; }
[[gnu::always_inline]] inline float thrice(float cosine) { return cosine * (4 * cosine * cosine - 3); }

/// x less its nearest whole number, |x| < 2^22.
[[gnu::always_inline]] inline float fraction(float x) {
  constexpr float kWhole = 12582912;  // physical: 1.5 * 2^23: the sum has no digits behind the point
  return x - ((x + kWhole) - kWhole);
}

[[gnu::always_inline]] inline CodeModel code_model(float wraps, float phase_rad, float moved_rad, CodeWave wave) {
  const float harmonic = wave.harmonic;
  const Turn once = turn_of(phase_rad);
  const float beyond = phase_rad * wave.inverse_ratio + moved_rad;  // within half a turn and a little
  const Turn a = once + turn_of(wrap_once(beyond + kTwoPiF * fraction(wraps * wave.inverse_ratio)));
  return {a, a.cos + harmonic * twice(a.cos), 1 - harmonic * thrice(once.cos)};
}

/// What the code frame shows beyond the prediction of the other three, about the motion and gain assumed, and its slope
/// over each of them. In DN; light: of dA/A; alone: of a phase that the code frame has for itself; skew: see kSkew;
/// second, third: of the projector's B2/B and B3/B.
struct Residual {
  float rest, by_motion, by_light, by_gain, by_alone, by_skew, by_alone_light, by_skew_light, by_second, by_third,
      modulation;
};

/// raw: above black; code: I_1 - A; phase_rad: of `raw`, with its order.
template <bool kSteady>
[[gnu::always_inline]] inline Residual code_residual(const Pixel& raw, float code, float phase_rad, float wraps,
                                                     const PixelChange& d, float gain, CodeWave wave) {
  const Lights lights = lights_of<kSteady>(d);
  const Pixel p = at_mid_burst(raw, lights, turns_of<kSteady>(d));
  const float b3 = root(p.cosine * p.cosine + p.sine * p.sine + 1e-6F), in_b = 1 / b3;
  const float c = p.cosine * in_b, s = p.sine * in_b, r = 1 + wave.inverse_ratio;
  const float turned = kSteady ? kCodeTime * d.rate : d.turned(kCodeTime);
  const CodeModel k = code_model(wraps, phase_rad + ahead(raw, p), r * turned, wave);
  const float b = b3 * k.modulation, by_swelling = -gain * k.angle.cos, by_turning = gain * r * k.angle.sin;
  // What frames that differ by f0, f2, f3 take from A, B cos and B sin, and that from the prediction.
  const auto slope = [&](float f0, float f2, float f3) {
    const float da = -kThird * (f0 + f2 + f3), dc = -kThird * (2 * f0 - f2 - f3), ds = -kInvRoot3 * (f3 - f2);
    return -da + by_swelling * (c * dc + s * ds) + by_turning * (c * ds - s * dc);
  };
  const float c0 = b * c, s0 = b * s;  // B cos and B sin of the three frames
  const float c2 = -0.5F * c0 - kHalfRoot3 * s0, c3 = -0.5F * c0 + kHalfRoot3 * s0;
  const float s2 = -0.5F * s0 + kHalfRoot3 * c0, s3 = -0.5F * s0 - kHalfRoot3 * c0;
  const float by_alone = b * by_turning;
  return {.rest = (raw.mean + code) * lights.of_code - p.mean - gain * b * k.light,
          .by_motion = slope(-kFirstTime * s0, -kSecondTime * s2, -kThirdTime * s3) + kCodeTime * by_alone,
          .by_light = slope(kFirstTime * (p.mean + c0), kSecondTime * (p.mean + c2), kThirdTime * (p.mean + c3)) -
                      kCodeTime * (p.mean - b * by_swelling),
          .by_gain = -b * k.light,
          .by_alone = by_alone,
          .by_skew = slope(-kFirstSkew * s0, -kSecondSkew * s2, -kThirdSkew * s3),
          .by_alone_light = b * by_swelling - p.mean,
          .by_skew_light = slope(kFirstSkew * (p.mean + c0), kSecondSkew * (p.mean + c2), kThirdSkew * (p.mean + c3)),
          .by_second = b * slope(twice(c0 / b), twice(c2 / b), twice(c3 / b)) - gain * b * twice(k.angle.cos),
          .by_third = b * (thrice(c) - gain * thrice(k.angle.cos)),
          .modulation = b};
}

}  // namespace enamel::pipeline
