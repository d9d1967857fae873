// Which neighbouring pixels can lie on one surface, and how trustworthy each pixel is for unwrapping.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

struct LinkConfig {
  /// chosen: by judgement. Steepest surface that counts as continuous between two pixels.
  float max_slope_deg = 75;
  /// Allowed on top, in sigma of the difference. derived: noise alone cuts one link in 16 000 by it.
  float noise_sigmas = 4;
  /// chosen: by judgement. Never link beyond this, however noisy.
  float max_deviation_rad = 1;
};

/// What a continuous surface looks like in phase, from the rig: per-pixel phase at mid-range (its differences are the
/// fringe carrier) and the largest change of the carrier that a slope of max_slope_deg makes between two pixels.
struct Carrier {
  const float* phase_mid_rad = nullptr;
  float slope_u_rad = 0, slope_v_rad = 0;
};

inline constexpr int kCleanQuality = 128;  ///< layout: a bit of LinkMaps::quality

struct LinkMaps {
  Map<std::uint8_t> east, south;  ///< 1: pixel and its right / lower neighbour are valid and on one surface
  /// Modulation-Laplace, log scale (2 steps an octave), 0 only where invalid; with kCleanQuality added where the
  /// Laplacian is no larger than three sigma of noise, all neighbours valid.
  Map<std::uint8_t> quality;
  std::size_t pairs = 0;   ///< valid horizontal neighbour pairs …
  std::size_t linked = 0;  ///< … and those of them that are linked
  std::vector<float> scratch;
};

/// quality = (1/sigma) / (1 + (L / (3 sqrt20 sigma))^2), L = Laplacian of wrapped differences (docs/decode.md §3).
void compute_links(const PhaseMaps& phase, const Carrier& carrier, const LinkConfig& config, LinkMaps& out);

/// Takes pixel i out of `links`; width: of the image.
void unlink(LinkMaps& links, std::size_t i, std::size_t width);

/// Rejects (kEdge) the pixels of every cut between two valid ones that do not continue their own surface in phase and
/// modulation, and their links: blur makes such pixels see both sides, and a flood must not leak from one side to the
/// other through them.
void reject_edges(LinkMaps& links, PhaseMaps& phase);

/// Rejects (kEdge) lit pixels whose modulation is under half of that two pixels away: most of their light is blurred
/// over from the neighbour, and so is their phase. Call before compute_links.
void reject_half_lit(const Map<float>& modulation_dn, Map<PixelReject>& reject);

/// Carrier of a baked rig.
struct RaySlopes {
  double inverse_depth = 0;        ///< 1/z at mid-range of the image's centre
  double inverse_depth_slope = 0;  ///< d(1/z)/dPhi there
  double px_x = 0, px_y = 0;       ///< normalised coordinate per pixel
};
[[nodiscard]] Carrier make_carrier(const float* phase_mid_rad, const RaySlopes& rays, double near_mm,
                                   float max_slope_deg);

}  // namespace enamel::pipeline
