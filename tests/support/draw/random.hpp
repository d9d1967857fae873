// Numbers for drawn tests: the same from one seed everywhere, but for what the mathematics library rounds.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace enamel::test {

/// SplitMix64. Each stream of a seed is a sequence of its own.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(seed * 0xD1342543DE82EF95U + stream * 0x2545F4914F6CDD1DU + 1) {}

  /// Uniform in [low, high).
  double operator()(double low, double high) { return low + (high - low) * unit(); }
  /// Uniform among the whole numbers low … high.
  int whole(int low, int high) { return low + static_cast<int>(unit() * (high - low + 1)); }
  bool chance(double p) { return unit() < p; }

  /// Of variance 1.
  double normal() {
    const double a = unit() + 0x1p-54, b = unit();
    return std::sqrt(-2 * std::log(a)) * std::cos(2 * std::numbers::pi * b);
  }

  /// A Poisson number of a small mean, by its distribution function.
  double poisson(double mean) {
    double share = std::exp(-mean), sum = share;
    const double x = unit();
    int k = 0;
    while (x > sum && share > 1e-18) sum += share *= mean / ++k;
    return k;
  }

 private:
  double unit() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
  }
  std::uint64_t state_;
};

}  // namespace enamel::test
