#include "pipeline/decode/mode_m/micro_wave_rows.hpp"

#include "pipeline/decode/mode_m/micro_wave_pixel.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_m/micro_wave_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void take_off_loop(const CodeRow& row, const RawRow& raw, const WaveValues& of_fringe, const WaveValues& of_code,
                   std::size_t width, const StraightRow& out) {
  const WaveValues fringe = of_fringe, finer = of_code;  // copies cannot alias what is written
  const CodeRow r = row;
  const float* __restrict raw_mean = raw.mean, * __restrict raw_cosine = raw.cosine;
  const float* __restrict raw_sine = raw.sine, * __restrict raw_code = raw.code;
  float *mean = out.mean, *cosine = out.cosine, *sine = out.sine, *code = out.code;
  float *modulation = out.modulation, *phase = out.phase;
  ENAMEL_INDEPENDENT  // what is written is the row's own
      for (std::size_t u = 0; u < width; ++u) {
    const PixelChange change = change_of(r, u);
    const Lights lights = lights_of<false>(change);
    const Turns turns = turns_of<false>(change);
    const WavePixel s = see_pixel(r, u, lights, turns);
    const Added add = added_by(s, lights, turns, fringe);
    const bool surface = r.wraps[u] > kNoSurface, placed = r.wraps[u] > kUnplaced;
    const float in_code = s.modulation * finer.at(code_turn(r, u, s, change).cos) / lights.of_code;
    const float level = select(placed, raw_mean[u] + raw_code[u] - in_code, mean[u] + code[u]);
    const float a = raw_mean[u] - add.mean, c = raw_cosine[u] - add.cosine, b = raw_sine[u] - add.sine;
    phase[u] += select(surface, wrap_once(atan2_poly(b, c) - phase[u]), 0);  // its wrap count stays
    modulation[u] = select(surface, root(b * b + c * c + 1e-6F), modulation[u]);
    code[u] = select(surface, level - a, code[u]);
    mean[u] = select(surface, a, mean[u]);
    cosine[u] = select(surface, c, cosine[u]);
    sine[u] = select(surface, b, sine[u]);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(take_off_loop);

void take_off_row(const CodeRow& row, const RawRow& raw, const WaveValues& fringe, const WaveValues& code,
                  std::size_t width, const StraightRow& out) {
  HWY_DYNAMIC_DISPATCH(take_off_loop)(row, raw, fringe, code, width, out);
}

}  // namespace enamel::pipeline
#endif
