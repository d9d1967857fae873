// Counter-based random numbers: a value depends on (seed, stream, counter) only, so neither thread count nor the order
// of evaluation changes an image. Mixer: the finaliser of SplitMix64 (Steele, Lea, Flood 2014).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace enamel::twin {

[[nodiscard]] constexpr std::uint64_t mix64(std::uint64_t z) noexcept {
  z += 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

struct NormalPair {
  double a = 0, b = 0;
};

class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, std::uint64_t stream) : key_(mix64(mix64(seed) ^ mix64(~stream))) {}

  [[nodiscard]] std::uint64_t bits(std::uint64_t counter) const noexcept { return mix64(key_ ^ mix64(counter)); }
  /// In the open interval (0, 1).
  [[nodiscard]] double uniform(std::uint64_t counter) const noexcept { return to_unit(bits(counter) >> 11U); }
  [[nodiscard]] double uniform(std::uint64_t counter, double low, double high) const noexcept {
    return low + (high - low) * uniform(counter);
  }
  /// Two independent standard normals (Box, Muller 1958).
  [[nodiscard]] NormalPair normals(std::uint64_t counter) const noexcept {
    const double u1 = uniform(2 * counter), u2 = uniform(2 * counter + 1);
    const double r = std::sqrt(-2.0 * std::log(u1)), angle = 2.0 * std::numbers::pi * u2;
    return {r * std::cos(angle), r * std::sin(angle)};
  }

 private:
  [[nodiscard]] static double to_unit(std::uint64_t v53) noexcept {
    return (static_cast<double>(v53) + 0.5) * 0x1.0p-53;
  }
  std::uint64_t key_;
};

}  // namespace enamel::twin
