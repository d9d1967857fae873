// What the closure residual of a burst tells beside noise (docs/decode.md §5): motion of the phase during the burst and
// the projector's second harmonic. With eps = phase change per frame interval and rho = B2/B, polarity undone:
//   residual = 2 B eps (sin - cos) + 4 B rho cos 2phi    where b = +1,      -2 B eps cos phi    where b = -1.
// Both also shift the phase, differently for the three ways in which a pixel was solved; left alone, the flips of the
// code would print steps on the surface. Errors of the phase, time origin mid-burst, first order:
//   four frames (b = +1)    eps/2 cos 2phi
//   b = -1                  2 rho cos 2phi cos phi + eps/2 (sin 2phi + cos 2phi)
//   three frames            2 rho cos 2phi cos phi + eps/2 (sin 2phi - 1)
// Where texture or shading passes by, A and B change alike: with g = dA/A per frame interval, the residual gains
//   -2 g (A + B cos phi + B sin phi) for b = +1,      2 g (A - B sin phi) for b = -1,      and the phase errs by
//   four frames (b = +1)    g A/B (cos phi + sin phi) + g/2 sin 2phi
//   b = -1                  g A/B (sin phi - cos phi) + g (1/2 sin 2phi - cos^2 phi)
//   three frames            g A/B sin phi - g cos^2 phi
// That is first order, by which blocks of the image are fitted. The correction is exact: each frame is divided by its
// own light, 1 + g t + g' t^2/2, and the equations of the frames, each at its own phase phi + eps t + eps' t^2/2, are
// solved for A, B and phi. The frames of the harmonic are solved alike and subtracted.
// Residuals about a motion known so far, and their columns, are made in the same way (closure_rows.hpp).
// A is above black.
#pragma once

#include <vector>

#include "pipeline/decode/mode_t/polarity.hpp"
#include "pipeline/decode/phase/grid_rows.hpp"

namespace enamel::pipeline {

struct ClosureConfig {
  /// chosen: by judgement.
  int block_px = 32;               ///< at least one fringe wide, or the two terms are not told apart
  float max_residual = 0.6F;       ///< of B; beyond it the pixel sees an edge or a glint, not motion
  float motion_prior_rad = 0.03F;  ///< spread of a block's eps about the burst's
  float harmonic_prior = 0.003F;   ///< spread of a block's rho about the burst's
};

/// What is known of motion (per frame interval), light and the projector at every pixel.
struct BurstErrors {
  Grid motion_rad;                   ///< eps
  Grid harmonic;                     ///< rho
  Grid light;                        ///< g = dA/A
  Grid motion_change, light_change;  ///< of eps; d2A/A
};

/// A burst under the errors known so far; black_dn: of the camera. Borrowed.
struct KnownBurst {
  const PhaseMaps& maps;
  const PolarityMaps& polarity;
  const BurstErrors& errors;
  float black_dn;
};

/// Estimates for the burst and for each block of block_px (row major).
struct ClosureFit {
  int columns = 0, rows = 0, block_px = 32;
  float motion_rad = 0, harmonic = 0;
  std::vector<float> block_motion_rad, block_harmonic;
  std::vector<float> block_sigma_rad;  ///< of block_motion_rad, from the noise of the frames and the prior

  /// Valid while this lives.
  [[nodiscard]] BurstErrors errors() const noexcept {
    return {{block_motion_rad.data(), columns, rows, block_px},
            {block_harmonic.data(), columns, rows, block_px},
            {},
            {},
            {}};
  }
  /// Index of the block that holds pixel (u, v).
  [[nodiscard]] std::size_t block_at(int u, int v) const noexcept {
    return static_cast<std::size_t>((v / block_px) * columns + u / block_px);
  }

  struct Work {
    std::vector<float> column_sums;
    std::vector<double> block_sums;
  } work;
};

/// Regularised least squares per block; uses pixels of full weight only.
void fit_closure(const PhaseMaps& maps, const PolarityMaps& polarity, const NoiseModel& noise,
                 const ClosureConfig& config, ClosureFit& out);

/// Brings phase_rad to mid-burst. Phases may leave [-pi, pi) a little.
void correct_phase(const PolarityMaps& polarity, const BurstErrors& errors, float black_dn, PhaseMaps& maps);

}  // namespace enamel::pipeline
