// The captured set "plaster_eye_12step_gray": a plaster relief under 12 sinusoids and a Gray code. Every third frame is
// a four-step burst of its own, solved here with the product's steps; the twelve frames and the code are its reference.
#pragma once

#include <string>
#include <vector>

#include "pipeline/decode/mode_t/frame_errors.hpp"
#include "pipeline/decode/phase/phase_ripple.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "tests/support/fold_error.hpp"
#include "tests/support/fringe_set.hpp"

namespace enamel::test {

struct PlasterSet {
  FringeImages images;  ///< 0 … 11 sinusoids, 12 … 17 Gray code
  StepSolution twelve;
  /// The twelve frames' own frame errors removed in the same way as a burst's. The raw twelve-step phase carries them:
  /// two of its frames are darker by 3 %.
  Map<float> reference_rad;
  Map<std::int32_t> half_fringe;  ///< Gray code; fringe order = (code + 1) >> 1
  calib::Rig rig;
  pipeline::RayDepth rays;
};

inline constexpr float kPlasterMinAmplitude_dn = 20;

[[nodiscard]] Result<PlasterSet> load_plaster(const std::string& folder);

struct PlasterFigures {
  FoldedError raw;       ///< four frames, nothing corrected, against the raw twelve-step phase
  FoldedError fourth;    ///< one term a1 sin 4phi, against the same
  FoldedError levelled;  ///< four terms of cos and sin 4m phi, against the same
  FoldedError full;      ///< and frame errors, against the reference with its frame errors removed
  FoldedError full_raw;  ///< the same against the raw twelve-step phase, which has frame errors of its own
  pipeline::FrameErrors frames;
  pipeline::PhaseRipple ripple;
  std::vector<double> raw_curve, full_curve;  ///< mean error in 64 bins of phase
  std::size_t reference_px = 0;               ///< pixels with amplitude above 20
  std::size_t solved_px = 0;                  ///< of these, in the unwrapped result
  double orders_equal = 0;          ///< share of solved pixels whose order is that of the Gray cell they lie in
  double orders_equal_literal = 0;  ///< floor(Phi/2pi) == (code + 1) >> 1: noise at a fringe's border counts as wrong
  double hanging_share = 0;         ///< of the solved pixels, in components of 64 px or more: not placed one by one
  double near_mm = 0, far_mm = 0;   ///< 1 and 99 % of depth
  Map<float> modulation_dn, depth_mm, error_rad;
  Map<std::int32_t> order;
};

/// Burst 0, 1 or 2: frames burst, burst + 3, burst + 6, burst + 9.
[[nodiscard]] Result<PlasterFigures> measure_plaster(const PlasterSet& set, std::size_t burst);

}  // namespace enamel::test
