// Rows of micro_wave.hpp, compiled per instruction set. Private to pipeline/decode.
#pragma once

#include <cstddef>

#include "pipeline/decode/mode_m/micro_refit_rows.hpp"
#include "pipeline/decode/phase/waveform.hpp"

namespace enamel::pipeline {

/// A row's frames as they came.
struct RawRow {
  const float *mean, *cosine, *sine, *code;
};

/// What is written: the row that CodeRow reads, element by element.
struct StraightRow {
  float *mean, *cosine, *sine, *code, *modulation, *phase;
};

/// take_off_harmonics of one row. Pixels of no surface keep what they have.
void take_off_row(const CodeRow& row, const RawRow& raw, const WaveValues& fringe, const WaveValues& code,
                  std::size_t width, const StraightRow& out);

}  // namespace enamel::pipeline
