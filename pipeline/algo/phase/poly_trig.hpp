// Arctangent in plain float arithmetic: the same bits from every compiler, and loops over it vectorise.
#pragma once

#include <bit>
#include <cstdint>

namespace enamel::algo {

inline constexpr float kPiF = 3.14159265358979F;
inline constexpr float kTwoPiF = 6.28318530717959F;

/// atan2(y, x) in [-pi, pi], error <= 4e-7 rad (tested). (0, 0) gives 0. Minimax odd polynomial of degree 15 on [0, 1].
[[nodiscard]] inline float atan2_poly(float y, float x) noexcept {
  const float ax = x < 0 ? -x : x;
  const float ay = y < 0 ? -y : y;
  const float big = ax > ay ? ax : ay;
  const float small = ax > ay ? ay : ax;
  const float q = small / (big > 1e-30F ? big : 1e-30F);
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
  a = ay > ax ? 0.5F * kPiF - a : a;
  a = x < 0 ? kPiF - a : a;
  return y < 0 ? -a : a;
}

/// Square root by Newton from a bit-level guess; relative error <= 3e-7 (tested). For loops where the compiler would
/// call a library function to set errno and so not vectorise.
[[nodiscard]] inline float sqrt_poly(float a) noexcept {
  const float b = a > 1e-30F ? a : 1e-30F;
  float r = std::bit_cast<float>(0x5f375a86U - (std::bit_cast<std::uint32_t>(b) >> 1U));  // 1/sqrt, 3 % off
  r = r * (1.5F - 0.5F * b * r * r);
  r = r * (1.5F - 0.5F * b * r * r);
  r = r * (1.5F - 0.5F * b * r * r);
  return b * r;
}

}  // namespace enamel::algo
