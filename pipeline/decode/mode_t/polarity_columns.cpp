#include "pipeline/decode/mode_t/polarity_columns.hpp"

#include <bit>
#include <cmath>
#include <cstdint>

#include "pipeline/decode/phase/poly_trig.hpp"
#define ENAMEL_NO_AVX512
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_t/polarity_columns.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// ln x for normal x > 0, error <= 1e-6 (1 + |ln x|): exponent, and 2 artanh((m - 1)/(m + 1)) of the mantissa m,
/// brought to sqrt(1/2) … sqrt(2).
[[gnu::always_inline]] inline float log_poly(float x) {
  constexpr std::uint32_t kRootHalf = 0x3F3504F3U, kMantissa = 0x007FFFFFU;  // layout: bits of a float
  const std::uint32_t shifted = std::bit_cast<std::uint32_t>(x) - kRootHalf;
  const auto exponent = static_cast<float>(static_cast<std::int32_t>(shifted) >> 23);
  const float m = std::bit_cast<float>((shifted & kMantissa) + kRootHalf);
  const float s = (m - 1) / (m + 1), s2 = s * s;
  return 0.69314718F * exponent + 2 * s * (1 + s2 * (0.33333333F + s2 * (0.2F + s2 * 0.14285714F)));
}

void columns_loop(const PhaseMaps& m, const NoiseModel& model, std::size_t at, std::size_t width, PolarityColumn* out) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const float* __restrict code = &m.code_dn[at], * __restrict sine = &m.sine_dn[at], * __restrict mean = &m.mean_dn[at];
  const float* __restrict modulation = &m.modulation_dn[at];
  PolarityColumn* __restrict column = out;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float d = code[u];
    const bool seen = d == d;
    const float s = select(seen, sine[u], 0), e = s * s;
    column[u].dot = select(seen, d, 0) * s;
    column[u].energy = e;
    column[u].noise = e * noise.variance(mean[u]);
    column[u].blur = modulation[u] * std::abs(s);
  }
}

void price_loop(float outlier_cost, std::size_t count, PolaritySaid* said) {
  constexpr float kLogWidth = 0.17967F;  // derived: ln(3/sqrt(2 pi)), T of a lying segment being within 1.5 of 0
  ENAMEL_INDEPENDENT
  for (std::size_t k = 0; k < count; ++k) {
    const float variance = said[k].variance;
    const float most = larger(outlier_cost + kLogWidth - 0.5F * log_poly(variance), 0);
    const float dp = said[k].code - 1, dm = said[k].code + 1, scale = 0.5F / variance;
    said[k].plus = smaller(scale * dp * dp, most);
    said[k].minus = smaller(scale * dm * dm, most);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(columns_loop);
HWY_EXPORT(price_loop);

void polarity_columns(const PhaseMaps& phase, const NoiseModel& noise, std::size_t at, std::size_t width,
                      PolarityColumn* out) {
  HWY_DYNAMIC_DISPATCH(columns_loop)(phase, noise, at, width, out);
}

void price_polarity(float outlier_cost, std::size_t count, PolaritySaid* said) {
  HWY_DYNAMIC_DISPATCH(price_loop)(outlier_cost, count, said);
}

}  // namespace enamel::pipeline
#endif
