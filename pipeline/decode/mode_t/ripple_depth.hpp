// How the ripple changes with depth. A projector out of focus loses its harmonics before its fringe (factor OTF(k) of
// harmonic k, X. Zhang et al. 2012), so the amplitudes of phase_ripple.hpp belong to one depth and its bin. Here the
// bins are polynomials of the depth, which have no edges: each moment is taken with weights 1, P1 and P2, orthonormal
// over the burst's own spans, so that each amplitude stands for itself and is shrunk by its own noise.
#pragma once

#include <array>
#include <span>

#include "pipeline/decode/phase/phase_ripple.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"

namespace enamel::pipeline {

/// P1 and P2 of d = x - mean, with x = Phi - RayDepth::phase_mid_rad: nearly linear in 1/z, and the same for all
/// pixels.
struct DepthPolynomials {
  double mean = 0;
  double reach = 0;  ///< |d| is limited to it: what was not counted shall not be extrapolated
  double per_d = 0;  ///< P1 = per_d d
  double scale = 0;  ///< P2 = scale (d^2 - tilt d - level); 0 where depths do not tell it from P1
  double tilt = 0, level = 0;

  [[nodiscard]] double first(double d) const noexcept { return per_d * d; }
  [[nodiscard]] double second(double d) const noexcept { return scale * (d * d - tilt * d - level); }
};

struct DepthRipple {
  DepthPolynomials depth;
  std::array<PhaseRipple, 2> of;  ///< amplitudes times P1 and P2, beside those of `level()`
  /// rad rms over the burst
  [[nodiscard]] double rms_rad() const noexcept;
};

/// `mean` is the ripple that level() found of the same pixels. None unless that stands clear of noise.
[[nodiscard]] DepthRipple level_by_depth(std::span<const CellSpan> spans, const PhaseMaps& maps, const RayDepth& rays,
                                         const PhaseMoments& moments, const PhaseRipple& mean);

/// Subtracts it from the placed pixels' phase.
void correct_by_depth(const DepthRipple& ripple, const Map<std::int16_t>& wraps, const RayDepth& rays, PhaseMaps& maps);

}  // namespace enamel::pipeline
