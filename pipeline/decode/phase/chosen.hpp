// Numbers of the phase step that no law gives; what is told when a decoder is made stands in PhaseConfig. Private to
// pipeline/decode.
#pragma once

#include <array>
#include <cstddef>

namespace enamel::pipeline {

/// Residual over its noise beyond which the four frames did not see one point of one surface: an edge passed by.
/// chosen: on the rendered sets. With 5 depth is truer by 6 to 9 % and half a percent of the pixels is lost
/// (docs/notes/decode-attempts.md, motion).
inline constexpr float kTornSigmas = 8;
/// chosen: by judgement. Of r/B (misfit.hpp); beyond it the pixel sees an edge or a glint, not motion.
inline constexpr float kMostMisfit = 0.6F;
/// Cells that a misfit is known in. chosen: by judgement. 64 residuals tell their mean square to 18 %.
inline constexpr int kMisfitCell_px = 8;

/// Of a bin of intensity (noise_model.cpp). chosen: by judgement. The median's own error is 12 % then.
inline constexpr std::size_t kMinBinPixels = 100;

/// Of a moving burst: motion and harmonics are found through each other. chosen: by judgement.
inline constexpr int kWavePasses = 2;
/// As are motion and light that changes by itself. chosen: by judgement.
inline constexpr int kLightPasses = 3;

/// Of light_change.hpp. chosen: by judgement. Spread of a block's unknowns about 0, far beyond what is seen: q, gain,
/// slopes of B/A, its ripple twice a fringe; B/A itself is not held. Equations of a block that has a say, and its B/A.
/// Course over the frames and map over the image are found in turn. Spread of a map's slopes and bends, over its mean.
inline constexpr std::array<double, 9> kLightSpread = {1, 1, 1, 0.3, 1, 1, 0.3, 0.3, 100};
inline constexpr double kLeastLightPixels = 100, kLeastLightContrast = 0.02;
inline constexpr int kCourseRounds = 4;
inline constexpr double kMapBend = 1;

/// Of true phase over the phase shown, and of a cosine over its level; of a level, above and below the wave's own:
/// noise. chosen: by judgement. Beyond the first noise would be amplified more than sigma tells.
inline constexpr double kLargestWaveSlope = 4, kBeyondWave = 0.25;

/// Waveform harmonics up to 4N + 1; a bulb of blur leaves fewer. chosen: on drawn gammas up to 2.8, of which one term
/// leaves 0.0028 rad and four 0.0003 (docs/notes/design-figures.md).
inline constexpr std::size_t kRippleTerms = 4;
/// chosen: by judgement. Enough for an amplitude to 1.4e-3 rad, 1/(2 sqrt(2 n)), if phases were random.
inline constexpr double kEnoughPixels = 60000;

}  // namespace enamel::pipeline
