// The vector (C, S) of a stretch of pixels to phase, modulation and sigma: the loops of slow operations, apart from
// those that make the vector. A processor looks some 200 instructions ahead; one long loop that ends in division,
// polynomial and root would wait for each of them in every turn, short ones overlap several turns. Private to
// pipeline/decode.
#pragma once

#include <cstddef>

#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {

/// layout: pixels between the loops: they stay in the first-level cache.
inline constexpr std::size_t kPolarStretch = 256;

struct PolarIn {
  const float *cosine, *sine;
  const float* variance_b4;  ///< variance of the phase times B^4
};

struct PolarOut {
  float *phase, *modulation, *sigma;
};

/// For the instruction set of whoever calls. Nothing of `out` may overlap `in`.
[[gnu::always_inline]] inline void to_polar(const PolarIn& in, std::size_t count, const PolarOut& out) {
  const float* __restrict cosine = in.cosine, * __restrict sine = in.sine, * __restrict variance = in.variance_b4;
  float* __restrict phase = out.phase, * __restrict modulation = out.modulation, * __restrict sigma = out.sigma;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < count; ++u) {
    const float b2 = cosine[u] * cosine[u] + sine[u] * sine[u] + 1e-6F;
    modulation[u] = root(b2);
    sigma[u] = root(variance[u]) / b2;
  }
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < count; ++u) phase[u] = atan2_poly(sine[u], cosine[u]);
}

}  // namespace enamel::pipeline
