#include "pipeline/decode/mode_t/polarity_rows.hpp"

#include <algorithm>
#include <array>

#include "pipeline/decode/phase/polar_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_t/polarity_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// Of a row, kPolarStretch pixels at a time. Bytes and short numbers are widened: a loop that mixes them with floats is
/// unrolled until its values no longer fit the registers.
struct Stretch {
  std::array<std::int32_t, kPolarStretch> cell;
  std::array<float, kPolarStretch> variance_b4, phase;
};

/// S, the closure residual and b w of frame 3's part; variance of the phase times B^4.
void join_frame(const NoiseModel& model, const PolarityConfig& config, std::size_t at, std::size_t count,
                Stretch& stretch, PhaseMaps& m, PolarityMaps& out) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const float drop = config.flip_drop_rad, ramp = 1.0F / (config.flip_full_rad - config.flip_drop_rad);
  constexpr float kFar = 10, kUseless = -100;  // layout: rad, beside distances of up to pi
  const std::int32_t* __restrict cell = stretch.cell.data();
  float* __restrict variance = stretch.variance_b4.data();
  const float* __restrict mean = &m.mean_dn[at], * __restrict cosine = &m.cosine_dn[at];
  const float* __restrict phase = &m.phase_rad[at];
  float* __restrict sine = &m.sine_dn[at], * __restrict code = &m.code_dn[at], * __restrict weight = &out.weight[at];
  ENAMEL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const float a = mean[i], c = cosine[i], s3 = sine[i], d = code[i];
    const int bits = cell[i];
    const float b = select((bits & kMinus) != 0, -1, 1);
    const float t = phase[i] + select((bits & kUpperHalf) != 0, kPiF, 0);
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
    variance[i] = e0 * e0 * noise.variance(a + c) + e2 * e2 * noise.variance(a - c) + e1 * e1 * noise.variance(a - s3) +
                  e3 * e3 * noise.variance(a + b * bd);
    sine[i] = s;
    code[i] = s3 - b * d;
    weight[i] = b * w;
  }
}

/// Where the new phase wraps otherwise than the old one, the pixel's wrap count makes up for it.
void replace_phase(const std::int16_t* wraps_of_cell, std::size_t count, const Stretch& stretch, float* phases,
                   std::int16_t* turns) {
  const float* __restrict now = stretch.phase.data();
  float* __restrict phase = phases;
  const std::int16_t* __restrict of_cell = wraps_of_cell;
  std::int16_t* __restrict wraps = turns;
  ENAMEL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const int step = static_cast<int>(now[i] - phase[i] > kPiF) - static_cast<int>(now[i] - phase[i] < -kPiF);
    wraps[i] = static_cast<std::int16_t>(of_cell[i] - step);
  }
  for (std::size_t i = 0; i < count; ++i) phase[i] = now[i];
}

void solve_row(const PolarityRow& row, std::size_t at, std::size_t begin, std::size_t end, const NoiseModel& noise,
               const PolarityConfig& config, PhaseMaps& m, PolarityMaps& out) {
  Stretch stretch;
  for (std::size_t from = begin; from < end; from += kPolarStretch) {
    const std::size_t count = std::min(kPolarStretch, end - from), first = at + from;
    const std::uint8_t* __restrict bits = row.cell + from;
    std::int32_t* __restrict cell = stretch.cell.data();
    for (std::size_t i = 0; i < count; ++i) cell[i] = bits[i];
    join_frame(noise, config, first, count, stretch, m, out);
    to_polar({&m.cosine_dn[first], &m.sine_dn[first], stretch.variance_b4.data()}, count,
             {stretch.phase.data(), &m.modulation_dn[first], &m.sigma_rad[first]});
    replace_phase(row.wraps + from, count, stretch, &m.phase_rad[first], &out.wraps[first]);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(solve_row);

void solve_polarity_row(const PolarityRow& row, std::size_t at, std::size_t begin, std::size_t end,
                        const NoiseModel& noise, const PolarityConfig& config, PhaseMaps& maps, PolarityMaps& out) {
  HWY_DYNAMIC_DISPATCH(solve_row)(row, at, begin, end, noise, config, maps, out);
}

}  // namespace enamel::pipeline
#endif
