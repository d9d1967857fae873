// Arctangent in plain float arithmetic: the same bits from every compiler, and loops over it vectorise.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

/// Before a loop: its iterations touch different elements, whatever the pointers' names suggest.
#if defined(__clang__)
#define ENAMEL_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define ENAMEL_INDEPENDENT _Pragma("GCC ivdep")
#endif

namespace enamel::algo {

inline constexpr float kPiF = 3.14159265358979F;
inline constexpr float kTwoPiF = 6.28318530717959F;

/// c ? a : b without a branch that a compiler could thread through a loop: loops of selects vectorise everywhere.
[[nodiscard]] inline float select(bool c, float a, float b) noexcept {
  const std::uint32_t mask = 0U - static_cast<std::uint32_t>(c);
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(a) & mask) | (std::bit_cast<std::uint32_t>(b) & ~mask));
}

[[nodiscard]] inline float smaller(float a, float b) noexcept { return a < b ? a : b; }
[[nodiscard]] inline float larger(float a, float b) noexcept { return a > b ? a : b; }

/// atan2(y, x) in [-pi, pi], error <= 4e-7 rad (tested). (0, 0) gives 0. Minimax odd polynomial of degree 15 on [0, 1].
[[nodiscard]] inline float atan2_poly(float y, float x) noexcept {
  const float ax = std::abs(x), ay = std::abs(y);
  const float big = larger(larger(ax, ay), 1e-30F);
  const float q = smaller(ax, ay) / big;
  const float s = q * q;
  float p = -0.004054556135088205F;
  p = p * s + 0.021862918511033058F;
  p = p * s - 0.05591227114200592F;
  p = p * s + 0.09642193466424942F;
  p = p * s - 0.1390862762928009F;
  p = p * s + 0.19946564733982086F;
  p = p * s - 0.33329859375953674F;
  p = p * s + 0.9999993443489075F;
  float a = p * q;
  a = select(ay > ax, 0.5F * kPiF - a, a);
  a = select(x < 0, kPiF - a, a);
  return std::copysign(a, y);
}

/// Square root, correctly rounded by IEEE 754. (std::sqrt vectorises where errno is switched off: see CMakeLists.txt.)
[[nodiscard]] inline float root(float a) noexcept { return std::sqrt(a); }

/// d brought into [-pi, pi]; |d| <= 3 pi.
[[nodiscard]] inline float wrap_once(float d) noexcept {
  const float e = select(d > kPiF, d - kTwoPiF, d);
  return select(e < -kPiF, e + kTwoPiF, e);
}

}  // namespace enamel::algo
