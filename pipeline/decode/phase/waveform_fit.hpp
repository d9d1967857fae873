// The projector's waveform from one burst, before any fringe order is known. A wave that is no cosine shows in three
// ways in what three frames say when they are solved as cosines, all of them periodic in the phase they say:
//   pixels crowd at some phases (true phase is spread evenly over whole fringes), the modulation B ripples about that
//   of its neighbourhood, and so does the mean A.
// Moments of the three over the burst are compared with those of a wave of harmonics h, and h is found by least
// squares.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/phase/waveform.hpp"

namespace enamel::pipeline {

/// Means over pixels, one a fold of the FrameScheme.
struct WaveMoments {
  double pixels = 0;
  std::vector<double> crowding;    ///< <f(phi)>
  std::vector<double> modulation;  ///< <(B/B_local - 1) f(phi)>
  std::vector<double> mean;        ///< <(A - A_local)/B_local f(phi)>
};

/// Of valid pixels of every `row_step`-th row; local: mean over one fringe of the row, fringe_px wide at mid-range.
[[nodiscard]] WaveMoments wave_moments(const PhaseMaps& maps, const FrameScheme& frames, int fringe_px, int row_step);

struct WaveFitConfig {
  int row_step = 4;             ///< layout: of the rows that are asked
  double glance_pixels = 8000;  ///< layout: of those that tell whether to ask: moments to 0.008 by counting
  /// Spread of a burst's moments that its surfaces leave beside counting noise. chosen: by judgement, on the rendered
  /// units of other makers.
  double crowding_spread = 0.01, ripple_spread = 0.004;
  /// Spread of h_2 … h_5 over projectors. derived: a gamma of 1 to 2.8 has (g-1)/(g+2), (g-2)/(g+3) of that, and so on
  /// (Liu et al. 2010), of which blur leaves less; the last two are held, for motion looks like them.
  std::array<double, kWaveHarmonics> prior{0.3, 0.1, 0.002, 0.001};
  double min_pixels = 2000;  ///< chosen: by judgement. With fewer nothing is said.
  /// Of Waveform::strength. chosen: on synthetic stairs, above the 0.056 that a motion of 0.3 rad a frame looks like.
  /// Below, what is left is undone once orders are known (docs/decode.md §6).
  double least_strength = 0.06;
  /// Of h_2 and h_3: what a burst's estimate is off by, and of them what defocus takes more or less from burst to
  /// burst. chosen: on drawn units of other makers.
  std::array<double, 2> learned_spread{0.015, 0.012}, defocus_share{0.12, 0.25};
  /// chosen: by judgement. So many bursts that show a cosine, or a wave as strong as that, are believed: what motion
  /// looks like differs from burst to burst.
  double sure_bursts = 4, least_learned = 0.03;
  double blur_taken = 0.08;  ///< derived: (2 pi sigma/period)^2/2 of a blur of 1.6 px at 25 px a fringe
};

/// What a burst's harmonics are expected to be: Gaussians, each by itself.
struct WavePrior {
  Waveform mean;
  std::array<double, kWaveHarmonics> sigma{};
  double least_strength = 0;  ///< below it nothing is undone

  bool operator==(const WavePrior&) const = default;
};

struct WaveFit {
  Waveform wave;
  double cost = 0;  ///< twice the negative log likelihood, prior included, but for what all priors share
};
/// Least squares from the prior's mean.
[[nodiscard]] WaveFit fit_waveform(const WaveMoments& moments, const FrameScheme& frames, const WavePrior& prior,
                                   const WaveFitConfig& config);

struct FoundWave {
  Waveform wave;                  ///< to be undone; a cosine where none is clear
  std::optional<Waveform> shown;  ///< by this burst alone, however weak; nothing where too few pixels tell
};
/// priors: what the wave may be, each a possibility of its own; none: it is known to be a cosine, and the burst is not
/// asked. A few rows tell whether there is anything to find. Where too few pixels tell, a single prior is taken at its
/// word. fringe_px: as for wave_moments.
[[nodiscard]] FoundWave find_waveform(const PhaseMaps& maps, const FrameScheme& frames, int fringe_px,
                                      const WaveFitConfig& config, std::span<const WavePrior> priors);

}  // namespace enamel::pipeline
