// Mode M once orders are known: its code frame tells the motion within the burst, and joins the phase as a fourth
// frame.
//
// Frame k is taken t_k = -3/2, -1/2, 1/2, 3/2 intervals after mid-burst; a phase that moves by eps an interval makes
// the three phase frames A + B cos(phi + 2 pi j/3 + eps t), which three equations undo exactly where eps is known, and
// its change eps', which adds eps' t^2/2, and how light changes, x = I / (1 + t g + t^2 g'/2). The
// code frame, slot 1, is A + g B cos(r (Phi + eps t_1)) with r = 1 + 1/L and g what blur leaves of the finer fringe
// beside the coarser. Mode M thus has a residual of its own, first order in eps (A_e, B_e, phi_e: what eps did to the
// three-frame solution, per eps):
//   R = I_1 - A - g B cos r Phi    =  eps B (...)    dR/deps = -A_e - g B_e cos r Phi + g r B sin(r Phi) (phi_e + t_1)
// Least squares over blocks of the image, g beside eps, give the motion; after that the code frame is a measurement of
// phi with slope -g r B sin r Phi, which brings sigma from 0.816 to 0.726 sigma_n/B on average (docs/decode.md §5).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/decode/mode_m/code_strips.hpp"
#include "pipeline/decode/mode_m/micro_code.hpp"
#include "pipeline/decode/phase/grid_rows.hpp"
#include "pipeline/decode/phase/misfit.hpp"
#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

struct MicroRefitConfig {
  int block_px = 32;  ///< chosen: by judgement, a fringe wide at least
  /// layout: of the rows that the last pass asks for the motion; twice that the one before.
  int row_step = 4;
  /// chosen: by judgement.
  int passes = 2;                   ///< of the fit, each to first order about the motion found before
  float max_residual = 0.6F;        ///< of B; beyond it the pixel sees an edge or a glint, not motion
  float motion_prior_rad = 0.01F;   ///< spread of a block's eps about the burst's
  float gain_prior = 0.05F;         ///< spread of a block's g about the burst's
  float largest_motion_rad = 0.4F;  ///< estimates are held to this
  /// A code frame further off does not join. derived: noise alone loses one pixel in 16 000 by it.
  float outlier_sigmas = 4;
  float torn_sigmas = kTornSigmas;  ///< ... and further off, an edge passed by
  /// Gain that other orders are judged under at most: blur leaves no more of the finer fringe than of the coarser, and
  /// a block that finds more explains pixels of a wrong order. chosen: on 10 000 rows of teeth
  /// (docs/notes/decode-attempts.md, orders).
  float largest_gain = 1.05F;
  /// Log likelihood ratio beyond which a strip along an edge is of another order (code_strips.hpp). derived: noise
  /// alone reaches it with a probability below exp(-12).
  float strip_evidence = 12;
};

/// What a rigid motion does to every pixel, beside what the blocks of micro_refit.hpp tell. Borrowed.
struct SurfaceMotion {
  Grid rate_rad;                       ///< eps, in place of the blocks'
  Grid light;                          ///< dA/A of light above black per frame interval, the same of B
  Grid rate_change_rad, light_change;  ///< of eps per interval; d2A/A: both belong to the surface and pass by with it
};

/// Motion and gain for the burst and its blocks; between their middles bilinear.
struct MicroMotion {
  float motion_rad = 0;  ///< eps
  float gain = 1;        ///< g
  float black_dn = 0;
  int columns = 0, rows = 0, block_px = 32;
  std::vector<float> block_motion_rad, block_sigma_rad, block_gain;  ///< row major; sigma: by noise and prior
  SurfaceMotion surface;                                             ///< the fit leaves none

  /// What holds at every pixel. Valid while this and what `surface` borrows live.
  [[nodiscard]] SurfaceMotion everywhere() const noexcept {
    return surface.rate_rad.nodes != nullptr ? surface : SurfaceMotion{grid_of(block_motion_rad), {}, {}, {}};
  }
  [[nodiscard]] Grid gain_grid() const noexcept { return grid_of(block_gain); }

  struct Work {
    std::vector<double> sums;
    std::vector<float> column_sums;
  } work;

 private:
  [[nodiscard]] Grid grid_of(const std::vector<float>& values) const noexcept {
    return {values.data(), columns, rows, block_px};
  }
};

/// A burst whose orders are known. Borrowed.
struct MicroBurst {
  const PhaseMaps& maps;           ///< of compute_micro_phase and correct_third_harmonic
  const Map<std::int16_t>& wraps;  ///< of place_spans
  const MicroCode& code;
  float third_rad;  ///< a1 of correct_third_harmonic
  const NoiseModel& noise;
};

/// Without placed pixels: no motion, g = 1.
void fit_micro_motion(const MicroBurst& burst, const MicroRefitConfig& config, MicroMotion& out);

/// The gain of the blocks anew, under the motion and light of the surface: light changes what the code frame
/// shows of the modulation as a gain would.
void refit_micro_gain(const MicroBurst& burst, const MicroRefitConfig& config, MicroMotion& motion);

/// Rewrites mean, cosine, sine, modulation, code and phase of all surfaces' pixels, placed or not, as they were at
/// mid-burst. Phases may leave [-pi, pi) a little; their turns stay.
void undo_micro_motion(const Map<std::int16_t>& wraps, const MicroMotion& motion, PhaseMaps& maps);

/// All pixels, whether or not their order is known, as the code frame would see them: under the light of mid-burst,
/// with the phase of kCodeTime; sigma and mask are those of `maps`.
void move_to_code_frame(const MicroMotion& motion, const PhaseMaps& maps, PhaseMaps& out);

/// What the code frame is compared with. Borrowed.
struct CodeJoin {
  std::span<const CellSpan> spans;  ///< as for place_spans
  const Map<std::int16_t>& wraps;
  const MicroCode& code;
  const MicroMotion& motion;
  float third_rad;
  const NoiseModel& noise;
};

/// What looks on while the code frame joins.
struct CodeJoinChecks {
  CodeStrips& strips;
  Misfit* misfit = nullptr;  ///< widens sigma_rad by what the code frames still differ from their predictions by
};

/// The code frame joins phase_rad and sigma_rad, after undo_micro_motion. Pixels without code, or whose code is an
/// outlier, keep their three-frame solution; those whose code is torn_sigmas off are rejected as edges, and strips
/// along the ends of runs whose code speaks for another order as kRelative.
void join_code_frame(const CodeJoin& in, const MicroRefitConfig& config, PhaseMaps& maps, const CodeJoinChecks& checks);

}  // namespace enamel::pipeline
