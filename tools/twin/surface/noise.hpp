// Smooth noise over space from a seed: value noise on a unit lattice, blended by quintic weights (Perlin 2002).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "tools/twin/optics/random.hpp"

namespace enamel::twin {

/// In [-1, 1], twice differentiable, feature size about 1.
[[nodiscard]] inline double value_noise(const Eigen::Vector3d& p, std::uint64_t seed) {
  std::int64_t cell[3];
  double w[3];
  for (int i = 0; i < 3; ++i) {
    const double f = std::floor(p[i]);
    cell[i] = static_cast<std::int64_t>(f);
    const double t = p[i] - f;
    w[i] = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
  }
  double sum = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    std::uint64_t key = seed;
    double weight = 1;
    for (unsigned i = 0; i < 3; ++i) {
      const bool high = ((corner >> i) & 1U) != 0;
      key = mix64(key ^ static_cast<std::uint64_t>(cell[i] + (high ? 1 : 0)));
      weight *= high ? w[i] : 1.0 - w[i];
    }
    sum += weight * (static_cast<double>(key >> 11U) * 0x1.0p-52 - 1.0);
  }
  return sum;
}

}  // namespace enamel::twin
