#include "pipeline/algo/phase/polarity_rows.hpp"

#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/phase/polarity_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

void solve_row(const PolarityRow& row, std::size_t at, std::size_t begin, std::size_t end, const NoiseModel& model,
               const PolarityConfig& config, PhaseMaps& m, PolarityMaps& out) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const float drop = config.flip_drop_rad, ramp = 1.0F / (config.flip_full_rad - config.flip_drop_rad);
  constexpr float kFar = 10, kUseless = -100;  // rad, beside distances of up to pi
  const std::uint8_t* __restrict cell = row.cell;
  const std::int16_t* __restrict cell_turn = row.turn;
  const float* __restrict mean = &m.mean_dn[at], * __restrict cosine = &m.cosine_dn[at];
  float* __restrict sine = &m.sine_dn[at], * __restrict code = &m.code_dn[at];
  float* __restrict modulation = &m.modulation_dn[at], * __restrict phase = &m.phase_rad[at];
  float* __restrict sigma = &m.sigma_rad[at], * __restrict weight = &out.weight[at];
  std::int16_t* __restrict turn = &out.turn[at];
  ENAMEL_INDEPENDENT
  for (std::size_t i = begin; i < end; ++i) {
    const float a = mean[i], c = cosine[i], s3 = sine[i], d = code[i], old = phase[i];
    const int bits = cell[i];
    const float b = select((bits & kMinus) != 0, -1, 1);
    const float t = old + select((bits & kUpperHalf) != 0, kPiF, 0);
    const float to_low = t + select((bits & kLowFlip) != 0, 0, kFar);
    const float to_high = kPiF - t + select((bits & kHighFlip) != 0, 0, kFar);
    const float nearest = select((bits & kOutside) != 0, kUseless, smaller(to_low, to_high));
    const float x = (nearest - drop) * ramp;
    const bool usable = d == d;
    const float w = select(usable, smaller(larger(x, 0), 1), 0);
    const float bd = select(usable, b * d, s3);
    const float s = s3 + 0.5F * w * (bd - s3);
    const float g = 1 - 0.5F * w * (1 + b);
    const float e0 = 0.5F * (c * g - s), e2 = 0.5F * (c * g + s), e1 = c * (1 - 0.5F * w), e3 = 0.5F * c * w;
    const float var = e0 * e0 * noise.variance(a + c) + e2 * e2 * noise.variance(a - c) +
                      e1 * e1 * noise.variance(a - s3) + e3 * e3 * noise.variance(a + b * bd);
    const float b2 = c * c + s * s + 1e-6F;
    const float p = atan2_poly(s, c);
    const int step = static_cast<int>(p - old > kPiF) - static_cast<int>(p - old < -kPiF);
    sine[i] = s;
    code[i] = s3 - b * d;
    modulation[i] = root(b2);
    phase[i] = p;
    sigma[i] = root(var) / b2;
    weight[i] = b * w;
    turn[i] = static_cast<std::int16_t>(cell_turn[i] - step);
  }
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(solve_row);

void solve_polarity_row(const PolarityRow& row, std::size_t at, std::size_t begin, std::size_t end,
                        const NoiseModel& noise, const PolarityConfig& config, PhaseMaps& maps, PolarityMaps& out) {
  HWY_DYNAMIC_DISPATCH(solve_row)(row, at, begin, end, noise, config, maps, out);
}

}  // namespace enamel::algo
#endif
