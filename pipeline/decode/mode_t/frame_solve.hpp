// The equations of mode T's frames at their own times, solved for one pixel at mid-burst, for loops over rows (single
// pixels: three_frames.hpp). With what each frame's phase differs by from mid-burst, a_k (frame_turns.hpp):
//   x0 = A + C cos a0 - S sin a0      x1 = A - S cos a1 - C sin a1
//   x2 = A - C cos a2 + S sin a2      x3 = A + b (S cos a3 + C sin a3)
// Private to pipeline/decode.
#pragma once

#include "pipeline/decode/phase/frame_turns.hpp"

namespace enamel::pipeline {

/// A pixel above black, or what is left of it at mid-burst.
struct FourStepPixel {
  float mean, cosine, sine;
};

/// Values of the four frames above black, under the light of mid-burst.
struct FourFrames {
  float x0, x1, x2, x3;
};

/// Of frames 0 to 2.
[[nodiscard, gnu::always_inline]] inline FourStepPixel solve_first_three(const FourFrames& x, const Turns& t) {
  const float even_c = t.a0.cos + t.a2.cos, even_s = -t.a0.sin - t.a2.sin, even = x.x0 - x.x2;
  const float odd_c = t.a1.sin + 0.5F * (t.a0.cos - t.a2.cos), odd_s = t.a1.cos - 0.5F * (t.a0.sin - t.a2.sin);
  const float odd = 0.5F * (x.x0 + x.x2) - x.x1;
  const float inverse = 1 / (even_c * odd_s - even_s * odd_c);
  const float c = (even * odd_s - even_s * odd) * inverse, s = (even_c * odd - even * odd_c) * inverse;
  return {0.5F * (x.x0 + x.x2 - c * (t.a0.cos - t.a2.cos) + s * (t.a0.sin - t.a2.sin)), c, s};
}

/// What the frames of `p` show of a second harmonic, per B2/B.
[[nodiscard, gnu::always_inline]] inline FourFrames harmonic_of(const FourStepPixel& p, const Turns& t) {
  const float inv = 1 / root(p.cosine * p.cosine + p.sine * p.sine + 1e-6F);
  const float cos2 = (p.cosine - p.sine) * (p.cosine + p.sine) * inv, sin2 = 2 * p.cosine * p.sine * inv;
  const auto at = [&](const Turn& a) { return cos2 * (1 - 2 * a.sin * a.sin) - sin2 * 2 * a.sin * a.cos; };
  return {at(t.a0), -at(t.a1), at(t.a2), -at(t.a3)};
}

}  // namespace enamel::pipeline
