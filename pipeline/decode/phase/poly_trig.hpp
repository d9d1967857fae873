// Arctangent, sine, cosine and logarithm in plain float arithmetic: the same bits from every compiler, and loops over
// it vectorise.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "pipeline/types/loops.hpp"

namespace enamel::pipeline {

/// layout: numbers of mathematics.
inline constexpr float kPiF = 3.14159265358979F;
inline constexpr float kTwoPiF = 6.28318530717959F;

[[nodiscard]] inline float smaller(float a, float b) noexcept { return a < b ? a : b; }
[[nodiscard]] inline float larger(float a, float b) noexcept { return a > b ? a : b; }

/// What an arctangent of (x, y) is taken of: the lesser over the larger of |x|, |y|, in [0, 1]; 0 for (0, 0).
[[nodiscard]] inline float fold_octant(float y, float x) noexcept {
  const float ax = std::abs(x), ay = std::abs(y);
  return smaller(ax, ay) / larger(larger(ax, ay), 1e-30F);
}

/// From the arctangent of that, in [0, pi/4], to the angle of (x, y). (No `select`: g++ makes a blend of these, one
/// instruction each where the other's bits take four.)
[[nodiscard]] inline float unfold_octant(float a, float y, float x) noexcept {
  a = std::abs(y) > std::abs(x) ? 0.5F * kPiF - a : a;
  a = x < 0 ? kPiF - a : a;
  return std::copysign(a, y);
}

/// atan2(y, x) in [-pi, pi], error <= 4e-7 rad (tested). (0, 0) gives 0. Minimax odd polynomial of degree 15 on [0, 1].
[[nodiscard]] inline float atan2_poly(float y, float x) noexcept {
  const float q = fold_octant(y, x);
  const float s = q * q;
  float p = -0.004054556135088205F;
  p = p * s + 0.021862918511033058F;
  p = p * s - 0.05591227114200592F;
  p = p * s + 0.09642193466424942F;
  p = p * s - 0.1390862762928009F;
  p = p * s + 0.19946564733982086F;
  p = p * s - 0.33329859375953674F;
  p = p * s + 0.9999993443489075F;
  return unfold_octant(p * q, y, x);
}

/// sin x for |x| <= pi/2, error <= 2e-7 (tested). Minimax odd polynomial of degree 9.
[[nodiscard]] inline float sin_poly(float x) noexcept {
  const float s = x * x;
  float p = 2.5904881885696618e-06F;
  p = p * s - 0.00019800897608653056F;
  p = p * s + 0.00833289982085245F;
  p = p * s - 0.16666647634492743F;
  p = p * s + 0.9999999765896554F;
  return p * x;
}

/// cos x for |x| <= pi/2, error <= 2e-7 (tested). Minimax even polynomial of degree 8.
[[nodiscard]] inline float cos_poly(float x) noexcept {
  const float s = x * x;
  float p = 2.3153928219221687e-05F;
  p = p * s - 0.0013853704159568214F;
  p = p * s + 0.041663584673433396F;
  p = p * s - 0.49999905346266366F;
  return p * s + 0.9999999534661713F;
}

/// Square root, correctly rounded by IEEE 754. (std::sqrt vectorises where errno is switched off: see CMakeLists.txt.)
[[nodiscard]] inline float root(float a) noexcept { return std::sqrt(a); }

/// Natural logarithm of a normal x > 0, error <= 2e-7 of the larger of it and 1 (tested): the exponent, and a minimax
/// polynomial of the rest, 1 + f in [sqrt(1/2), sqrt(2)).
[[nodiscard]] inline float log_poly(float x) noexcept {
  constexpr std::int32_t kRootHalf = 0x3F3504F3;  // layout: bits of sqrt(1/2)
  const std::int32_t bits = std::bit_cast<std::int32_t>(x), exponent = (bits - kRootHalf) >> 23;
  const float f = std::bit_cast<float>(bits - exponent * (1 << 23)) - 1;
  float p = -0.10224198965860097F;
  p = p * f + 0.16141175734609606F;
  p = p * f - 0.17166907038544169F;
  p = p * f + 0.19910238546651057F;
  p = p * f - 0.2498057398204878F;
  p = p * f + 0.33334690993127963F;
  return (f * f * (f * p - 0.5F) + f) + static_cast<float>(exponent) * 0.69314718F;
}

/// d brought into [-pi, pi]; |d| <= 3 pi.
[[nodiscard]] inline float wrap_once(float d) noexcept {
  const float e = d > kPiF ? d - kTwoPiF : d;
  return e < -kPiF ? e + kTwoPiF : e;
}

}  // namespace enamel::pipeline
