// How motion and light change a pixel from frame to frame of a burst, for loops over rows of either mode. Private to
// pipeline/decode.
#pragma once

#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {

/// layout: of slot 1, mode M's code frame, frame intervals after mid-burst.
inline constexpr float kCodeTime = -0.5F;

/// Of one pixel, per frame interval: eps and its change, dA/A and d2A/A.
struct PixelChange {
  float rate, rate_change, growth, growth_change;

  [[nodiscard, gnu::always_inline]] float light(float t) const { return 1 + t * growth + 0.5F * t * t * growth_change; }
  [[nodiscard, gnu::always_inline]] float turned(float t) const { return t * rate + 0.5F * t * t * rate_change; }
};

struct Turn {
  float cos, sin;
};

[[gnu::always_inline]] inline Turn operator+(const Turn& a, const Turn& b) {
  return {a.cos * b.cos - a.sin * b.sin, a.sin * b.cos + a.cos * b.sin};
}

[[gnu::always_inline]] inline Turn operator-(const Turn& a) { return {a.cos, -a.sin}; }

/// |a| <= pi and a little: by the half angle, which the polynomials cover.
[[gnu::always_inline]] inline Turn turn_of(float a) {
  const float s = sin_poly(0.5F * a), c = cos_poly(0.5F * a);
  return {1 - 2 * s * s, 2 * s * c};
}

/// What each frame's phase differs by from mid-burst, t eps + t^2/2 eps' at t = -3/2 ... 3/2.
struct Turns {
  Turn a0, a1, a2, a3;
};

/// From eps/2 and its triple, eps'/8 and its ninefold. kSteady: eps' is 0. Errors of a sine or cosine: 1e-6 for
/// |eps| <= 1 and |eps'| <= 0.3.
template <bool kSteady>
[[gnu::always_inline]] inline Turns turns_of(const PixelChange& d) {
  const float half = 0.5F * d.rate;
  const Turn one{cos_poly(half), sin_poly(half)};
  const float twice = 4 * one.sin * one.sin;
  const Turn three{one.cos * (1 - twice), one.sin * (3 - twice)};
  if constexpr (kSteady) return {-three, -one, one, three};
  const float near = 0.125F * d.rate_change, square = near * near, far = 9 * near;
  const Turn inner{1 - 0.5F * square, near - near * square * 0.16666667F}, outer{cos_poly(far), sin_poly(far)};
  return {outer + -three, inner + -one, inner + one, outer + three};
}

}  // namespace enamel::pipeline
