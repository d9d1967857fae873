// What the closure residual of a burst tells beside noise (algorithms.md §9): motion of the phase during the burst and
// the projector's second harmonic. With eps = phase change per frame interval and rho = B2/B, polarity undone:
//   residual = 2 B eps (sin - cos) + 4 B rho cos 2phi    where b = +1,      -2 B eps cos phi    where b = -1.
// Both also shift the phase, differently for the three ways in which a pixel was solved; left alone, the flips of the
// code would print steps on the surface. Errors of the phase, time origin mid-burst, first order:
//   four frames (b = +1)    eps/2 cos 2phi
//   b = -1                  2 rho cos 2phi cos phi + eps/2 (sin 2phi + cos 2phi)
//   three frames            2 rho cos 2phi cos phi + eps/2 (sin 2phi - 1)
#pragma once

#include <vector>

#include "pipeline/algo/phase/polarity.hpp"

namespace enamel::algo {

struct ClosureConfig {
  int block_px = 32;               ///< at least one fringe wide, or the two terms are not told apart
  float max_residual = 0.6F;       ///< of B; beyond it the pixel sees an edge or a glint, not motion
  float motion_prior_rad = 0.03F;  ///< spread of a block's eps about the burst's
  float harmonic_prior = 0.003F;   ///< spread of a block's rho about the burst's
};

/// Burst-wide and per-block estimates; blocks of block_px, row major.
struct ClosureFit {
  int columns = 0, rows = 0, block_px = 32;
  float motion_rad = 0, harmonic = 0;
  std::vector<float> block_motion_rad, block_harmonic;

  struct Work {
    std::vector<float> column_sums;
    std::vector<double> block_sums;
  } work;
};

/// Regularised least squares per block; uses pixels of full weight only.
void fit_closure(const PhaseMaps& maps, const PolarityMaps& polarity, const ClosureConfig& config, ClosureFit& out);

/// Subtracts the errors above from phase_rad, block estimates interpolated bilinearly. Phases may leave [-pi, pi) a
/// little.
void correct_phase(const PolarityMaps& polarity, ClosureFit& fit, PhaseMaps& maps);

/// a1 of the phase error a1 sin 4phi that a third harmonic makes, from the fact that true phase is spread evenly over
/// whole half fringes: a1 = -<cos 4phi>/2 over `whole` spans (§3). Standard error 1/(2 sqrt(2 N)).
struct FourthHarmonic {
  float a1_rad = 0;
  double pixels = 0;
};
[[nodiscard]] FourthHarmonic estimate_fourth_harmonic(std::span<const CellSpan> spans, const PhaseMaps& maps);

}  // namespace enamel::algo
