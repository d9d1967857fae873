// What harmonics add to a pixel's four frames, and rows of pixels without it (four_step_wave.hpp), compiled per
// instruction set. Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/phase/frame_turns.hpp"
#include "pipeline/decode/phase/waveform.hpp"

namespace enamel::pipeline {

inline constexpr Turn kQuarter{0, 1}, kHalf{-1, 0};  // layout: of a fringe, from frame to frame

/// Of one pixel's frames 0 to 3.
struct AddedFrames {
  float first, second, third, fourth;
};

/// turn: of the phase at mid-burst; last: of frame 3 against it, at the time of its exposure.
[[gnu::always_inline]] inline AddedFrames added_to(const WaveValues& wave, const Turn& turn, float modulation,
                                                   const Turn& last, const Turns& t, const PixelChange& change) {
  return {modulation * wave.at((turn + t.a0).cos) * change.light(-1.5F),
          modulation * wave.at((turn + kQuarter + t.a1).cos) * change.light(-0.5F),
          modulation * wave.at((turn + kHalf + t.a2).cos) * change.light(0.5F),
          modulation * wave.at((turn + last + t.a3).cos) * change.light(1.5F)};
}

/// A, C, S and D of four frames, solved by the first three.
struct SolvedFrames {
  float mean, cosine, sine, code;
};

/// The same frames less what is in them beside a cosine.
[[gnu::always_inline]] inline SolvedFrames less(const SolvedFrames& raw, const AddedFrames& add) {
  const float a = raw.mean - 0.5F * (add.first + add.third);
  return {a, raw.cosine - 0.5F * (add.first - add.third), a - (raw.mean - raw.sine - add.second),
          raw.mean + raw.code - add.fourth - a};
}

/// A row's pixels: as they came, and as the maps have them, which is rewritten.
struct WaveRow {
  const float *raw_mean, *raw_cosine, *raw_sine, *raw_code;
  const std::int16_t* wraps;  ///< of PolarityMaps
  const float* cell_wraps;    ///< wraps_of_cell
  const float* sign;          ///< of frame 3; 0: outside all spans, and nothing is written
  RowErrors errors;
  float *mean, *cosine, *sine, *code, *phase;
  const float* modulation;
};
void take_off_row(const WaveRow& row, const WaveValues& wave, std::size_t width);

}  // namespace enamel::pipeline
