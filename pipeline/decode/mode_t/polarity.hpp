// Second solution, once the absolute cell of a pixel and so its polarity b is known: frame 3 joins the other three.
//   S = S3 + w/2 (b D - S3);   w = 1: four frames (b = +1) or three frames with frame 1 and 3 averaged (b = -1);
//   w = 0 beside a flip of b, where the projector's blur has rounded frame 3: three frames (docs/decode.md §5).
#pragma once

#include <cstdint>
#include <span>

#include "pipeline/decode/mode_t/cell_signs.hpp"
#include "pipeline/decode/phase/cell_span.hpp"
#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

struct PolarityConfig {
  /// Frame 3 is not used nearer to a flip. derived: two sigma of a blur of 1.5 px in a period of 24, 2 * 2 pi 1.5/24.
  float flip_drop_rad = 0.7854F;
  /// chosen: by judgement. And counts fully from here on.
  float flip_full_rad = 1.0472F;
};

/// Per-pixel state that the correction steps need beside the phase.
struct PolarityMaps {
  Map<float> weight;        ///< b * w; 0 outside all spans
  Map<std::int16_t> wraps;  ///< Phi = phase_rad + 2 pi wraps, absolute; meaningful inside spans
};

/// spans: in row order. Rewrites sine_dn, modulation_dn, phase_rad, sigma_rad of the spans' pixels; code_dn becomes the
/// closure residual (I0+I2-I1-I3 with the polarity undone, DN; NaN stays NaN).
void apply_polarity(std::span<const CellSpan> spans, const CellSigns& signs, const NoiseModel& noise,
                    const PolarityConfig& config, PhaseMaps& maps, PolarityMaps& out);

}  // namespace enamel::pipeline
