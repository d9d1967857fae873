// Light that comes back from inside a tooth: it lowers the fringes' contrast and makes the surface seem deeper. What
// the burst shows of the first tells the second.
//
// Light returns in two shares: s from the surface, with full contrast and the right phase, and 1 - s from inside, with
// contrast M and from an apparent depth d, both of which the fringe's period p decides. So the contrast against an
// opaque surface's is r = s + (1 - s) M, and the apparent depth of the whole is (1 - s) M d / r = k (1/r - 1), with
// k = M d / (1 - M): what the surface's share is need not be known. k(p) is that of enamel by photon Monte Carlo
// (docs/mouth.md); dentine's and gum's are 1/2 to 2 times that, which is told in sigma.
#pragma once

#include "pipeline/decode/phase/noise_model.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/phase/waveform.hpp"
#include "pipeline/decode/steps/apparent_depth_field.hpp"
#include "pipeline/decode/steps/refined_phase.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/types/sight.hpp"

namespace enamel::pipeline {

struct TranslucencyConfig {
  /// Undo the apparent depth. Off: it is told all the same.
  bool correct = true;
  /// Of the measured pixels: fewer that look translucent are edges and slopes of something opaque, where a pixel sees
  /// more than one phase. chosen: on rendered bursts of ten units: plaster shows up to 0.002, teeth and gum more than
  /// 0.9.
  double least_share = 0.15;
};

/// What the rig says of a pattern on an opaque surface.
struct PatternOptics {
  float contrast = 1;             ///< amplitude / mean of the fringes as projected
  float period_per_mm{};          ///< the fringes' period on a facing surface, mm, over its distance, mm
  ApparentDepthField field = {};  ///< of light from inside, over the picture
};

struct SeenPattern {
  const RayDepth& rays;
  PatternOptics optics;
  float black_dn = 0;  ///< the sensor's
};

/// Takes the apparent depth off the phase, in place, of pixels that are kNone or kRelative, and adds its uncertainty to
/// their sigma. Of sight, veil_dn is light that no contrast is asked of; fills translucent_share and
/// apparent_depth_mm.
void undo_translucency(const SeenPattern& seen, const TranslucencyConfig& config, const RefinedPhase& refined,
                       Sight& sight, PhaseMaps& phase);

/// Contrast of the fringes as they leave a projector whose response makes `wave` of a cosine: its darkest level is
/// nearly dark, so that the mean light follows from the wave. `optics` of a linear one.
[[nodiscard]] PatternOptics seen_through(const Waveform& wave, PatternOptics optics) noexcept;

/// What blur leaves of it on an opaque surface.
[[nodiscard]] float plaster_contrast(const PatternOptics& optics) noexcept;

/// Apparent depth, mm, of a surface whose contrast is `ratio` of what was projected, at a period of 1 mm; it grows with
/// apparent_depth_growth(period). 0 for what is as opaque as plaster.
[[nodiscard]] float apparent_depth_at_1mm(float ratio) noexcept;
[[nodiscard]] float apparent_depth_growth(float period_mm) noexcept;

}  // namespace enamel::pipeline
