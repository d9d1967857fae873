// How far from a flip of the code frame 3 can be used, from the burst itself. Blur of projector and camera, of spread
// sigma rad, rounds the kink |sin phi| at a flip: at a phase t beyond it frame 3 shows, in B,
//   |t| + sigma h(|t|/sigma)        h(x) = 2 (n(x) - x (1 - N(x))) for a Gaussian of density n and integral N.
// Over both sides the rounding sums up to sigma^2 whatever the shape of the blur, so that its mean over all pixels
// within T of a flip is sigma^2 / 2T. Motion, light and harmonic are taken off first: they would pass for blur. t is
// that of frame 3's exposure; motion carries pixels towards the flip or across it.
#pragma once

#include <vector>

#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/mode_t/polarity.hpp"
#include "pipeline/decode/mode_t/torn.hpp"
#include "pipeline/decode/phase/misfit.hpp"

namespace enamel::pipeline {

struct FlipBlurConfig {
  /// chosen: by judgement.
  int block_px = 64;             ///< blur follows depth
  float drop_sigmas = 1.0F;      ///< frame 3 is not used nearer to a flip: rounded by 0.17 sigma, ...
  float full_sigmas = 1.75F;     ///< ... and counts fully from here on: 0.03 sigma
  float least_sigma_rad = 0.1F;  ///< of any projector and camera
  /// derived: T/2, half of PolarityConfig::flip_full_rad. What is rounded further is not seen whole within T.
  float largest_sigma_rad = 0.52F;
  /// chosen: by judgement. That the burst's own mean counts for in a block.
  float prior_pixels = 200;
};

/// Sigma at the nodes of a grid over the image.
struct FlipBlur {
  int columns = 0, rows = 0, block_px = 64;
  float burst_rad = 0;  ///< of all pixels
  std::vector<float> sigma_rad;

  /// Valid while this lives.
  [[nodiscard]] Grid grid() const noexcept { return {sigma_rad.data(), columns, rows, block_px}; }
  struct Work {
    std::vector<float> column_sums;
  } work;
};

/// For what only bursts that moved are asked. torn: started.
struct MovedBurst {
  Misfit& misfit;
  TornPixels& torn;
  const CellSigns& signs;
};

/// After apply_polarity with `polarity_config`, under the errors known; T is its flip_full_rad.
void fit_flip_blur(const KnownBurst& burst, const PolarityConfig& polarity_config, const FlipBlurConfig& config,
                   FlipBlur& out);

/// What is known when frame 3 joins near the flips. Borrowed.
struct FinishInput {
  const FlipBlur& blur;
  const BurstErrors& errors;
  const NoiseModel& noise;
  const FlipBlurConfig& config;
};

/// Joins frame 3 as near to the flips as `blur` allows, less its rounding, where apply_polarity did not: pixels that
/// are not rejected. Rewrites sine_dn, phase_rad, sigma_rad and code_dn (the rounding taken off) of `maps` and the
/// weights. Then brings phase_rad to mid-burst, as correct_phase does: both at once, row by row, while a row is in the
/// processor's caches. Phases may leave [-pi, pi) a little. Unless `moved` is null, torn pixels are then
/// sorted out (torn.hpp), and sigma_rad is widened by what the frames still contradict each other by.
void finish_phase(const FinishInput& in, PhaseMaps& maps, PolarityMaps& polarity, const MovedBurst* moved);

}  // namespace enamel::pipeline
