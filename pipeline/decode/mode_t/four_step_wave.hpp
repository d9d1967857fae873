// The projector's harmonics in mode T once orders and motion are known: what they add to each frame is predicted from
// the pixel's own phase, sign, motion and light, and taken off (waveform.hpp). Frame 3 shows the fringe at phi + 3
// pi/2, and where its sign is turned at phi + pi/2.
#pragma once

#include <span>

#include "pipeline/decode/mode_t/cell_signs.hpp"
#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/phase/cell_span.hpp"
#include "pipeline/decode/phase/raw_frames.hpp"
#include "pipeline/decode/phase/waveform.hpp"

namespace enamel::pipeline {

/// Takes the wave out of the maps before any order is known. Frame 3 is either like frame 1, and the first three frames
/// tell the phase, or its sign is plus, and all four do, which are blind to an even harmonic. Moving surfaces make
/// frames 1 and 3 differ by up to half of B at a quarter radian a frame; with more the sign is plus. kNoisy is decided
/// anew; saturated and dark pixels stay.
void linearise_four_step(const Waveform& wave, const PhaseConfig& config, PhaseMaps& maps);

/// Widens sigma_rad by how much less than a cosine the wave says of phases that three frames tell: of pixels in the
/// spans whose frame 3 repeats frame 1 or does not count. Beyond max_sigma_rad they are kNoisy.
void widen_by_wave(std::span<const CellSpan> spans, const CellSigns& signs, const Waveform& wave,
                   const PhaseConfig& config, PhaseMaps& maps);

struct WaveOfFrames {
  std::span<const CellSpan> spans;
  const CellSigns& signs;
  const RawFrames& raw;
  const Waveform& wave;
};

/// Of pixels in the spans. Beforehand `maps` is what apply_polarity left and phase_rad at mid-burst (correct_phase);
/// afterwards what compute_phase would have made of frames without harmonics, motion still within, for apply_polarity
/// anew.
void take_off_harmonics(const WaveOfFrames& in, const PolarityMaps& polarity, const BurstErrors& errors, float black_dn,
                        PhaseMaps& maps);

}  // namespace enamel::pipeline
