// One pixel of a mode M burst and what the projector's harmonics add to its frames (micro_wave.hpp). For loops over
// rows, compiled into each. Private to pipeline/decode.
#pragma once

#include "pipeline/decode/mode_m/micro_pixel.hpp"
#include "pipeline/decode/mode_m/micro_refit_rows.hpp"
#include "pipeline/decode/phase/waveform.hpp"

namespace enamel::pipeline {

[[gnu::always_inline]] inline PixelChange change_of(const CodeRow& row, std::size_t u) {
  return {row.motion_rad[u], row.motion_change_rad[u], row.light[u], row.light_change[u]};
}

/// A pixel at mid-burst.
struct WavePixel {
  Pixel pixel;
  float phase_rad, modulation;
};

[[gnu::always_inline]] inline WavePixel see_pixel(const CodeRow& row, std::size_t u, const Lights& lights,
                                                  const Turns& turns) {
  const Pixel raw{row.pixels.mean[u] - row.black_dn, row.pixels.cosine[u], row.pixels.sine[u]};
  const Pixel p = at_mid_burst(raw, lights, turns);
  const float modulation = root(p.cosine * p.cosine + p.sine * p.sine + 1e-6F);
  return {{p.mean, p.cosine, p.sine}, row.pixels.phase[u] + ahead(raw, p), modulation};
}

/// What harmonics add to frames 0, 2, 3, as A, C and S.
struct Added {
  float mean, cosine, sine;
};

[[gnu::always_inline]] inline Added added_by(const WavePixel& s, const Lights& lights, const Turns& turns,
                                             const WaveValues& fringe) {
  const Turn phase{s.pixel.cosine / s.modulation, s.pixel.sine / s.modulation};
  const float first = s.modulation * fringe.at((phase + turns.a0).cos) / lights.of_first;
  const float second = s.modulation * fringe.at((phase + kThirdTurn + turns.a2).cos) / lights.of_second;
  const float third = s.modulation * fringe.at((phase + -kThirdTurn + turns.a3).cos) / lights.of_third;
  return {kThird * (first + second + third), kThird * (2 * first - second - third), kInvRoot3 * (third - second)};
}

[[gnu::always_inline]] inline Turn code_turn(const CodeRow& row, std::size_t u, const WavePixel& s,
                                             const PixelChange& change) {
  const float r = 1 + row.inverse_ratio;
  return code_model(row.wraps[u], s.phase_rad, r * change.turned(kCodeTime), {row.inverse_ratio, 0}).angle;
}

}  // namespace enamel::pipeline
