#include "pipeline/decode/mode_t/four_step_wave_rows.hpp"

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_t/four_step_wave_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void take_off_loop(const WaveRow& row, const WaveValues& of_fringe, std::size_t width) {
  const WaveValues wave = of_fringe;  // copies cannot alias what is written
  const float* __restrict raw_mean = row.raw_mean, * __restrict raw_cosine = row.raw_cosine;
  const float* __restrict raw_sine = row.raw_sine, * __restrict raw_code = row.raw_code;
  const float* __restrict rate = row.errors.rate, * __restrict rate_change = row.errors.rate_change;
  const float* __restrict light = row.errors.light, * __restrict light_change = row.errors.light_change;
  const float* __restrict modulation = row.modulation, * __restrict sign = row.sign;
  const float* __restrict cell_wraps = row.cell_wraps;
  const std::int16_t* __restrict wraps = row.wraps;
  float* __restrict mean = row.mean, * __restrict cosine = row.cosine, * __restrict sine = row.sine;
  float* __restrict code = row.code, * __restrict phase = row.phase;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const PixelChange change{rate[u], rate_change[u], light[u], light_change[u]};
    const Turns turns = turns_of<false>(change);
    const bool in_span = sign[u] != 0;
    const float at_mid = phase[u] + kTwoPiF * (static_cast<float>(wraps[u]) - cell_wraps[u]);
    const float wrapped = wrap_once(select(in_span, at_mid, 0));
    const Turn last{0, select(sign[u] < 0, 1.0F, -1.0F)};
    const AddedFrames add = added_to(wave, turn_of(wrapped), modulation[u], last, turns, change);
    const SolvedFrames left = less({raw_mean[u], raw_cosine[u], raw_sine[u], raw_code[u]}, add);
    const float turned = wrap_once(wrap_once(atan2_poly(left.sine, left.cosine) - wrapped));
    mean[u] = select(in_span, left.mean, mean[u]);
    cosine[u] = select(in_span, left.cosine, cosine[u]);
    sine[u] = select(in_span, left.sine, sine[u]);
    code[u] = select(in_span, left.code, code[u]);
    phase[u] = select(in_span, at_mid + turned, phase[u]);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(take_off_loop);

void take_off_row(const WaveRow& row, const WaveValues& wave, std::size_t width) {
  HWY_DYNAMIC_DISPATCH(take_off_loop)(row, wave, width);
}

}  // namespace enamel::pipeline
#endif
