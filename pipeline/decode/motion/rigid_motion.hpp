// How the probe moved during the burst: the residual of all pixels (motion_view.hpp), explained by one rigid motion.
// Six unknowns for a whole image see through noise and curvature that a patch of the image cannot (docs/decode.md §5).
//
// Frame of reference: camera, mm, rad; all motion is of the surface seen from the camera, per frame interval. With the
// tangent plane m.P = 1 at a pixel (m = n/d, 1/z = q = m.r, r = (x, y, 1)) and the point's motion U = V + W x (P - P0),
// with shift V and turn W about the middle P0 of the measuring volume:
//   dq = -q m.U                      rate of the phase at the pixel  eps = dq / (dq/dPhi)
//   (dx, dy) = (Ux - x Uz, Uy - y Uz) q      image motion
//   light: dA = -(grad A + 4 A (x, y)/|r|^2) . image motion + A D     texture passes by; its own light changes
//   D = (7 l/|l|^2 - 4 a/(a.l) - n/(n.l)) . U + W . (n x l)/(n.l)
// Lambert, lit from the projector (l towards it, a its axis), both lenses darkening by the fourth power of the cosine:
// A ~ (a.l)^4 n.l/|l|^7 and, of the camera, |r|^-4, which stays with the pixel. A is above black. The modulation is
// taken to change as the light does: dB/B = dA/A. A surface of revolution without texture shows no turn about its axis:
// only what the motion does to phase and light is determined then.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "pipeline/decode/motion/motion_detail.hpp"
#include "pipeline/decode/motion/motion_images.hpp"
#include "pipeline/decode/motion/motion_nodes.hpp"
#include "pipeline/decode/motion/motion_samples.hpp"
#include "pipeline/decode/motion/motion_view.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"

namespace enamel::pipeline {

struct RigidMotionConfig {
  /// chosen: by judgement. Of B; beyond it the pixel sees an edge or a glint, not motion.
  float max_residual = 0.6F;
  /// Second round: residuals beyond this many rms are left out. derived: noise alone loses one pixel in 16 000 by it.
  float outlier_sigmas = 4;
  double shift_prior_mm = 0.12;   ///< spread of a hand's shift per frame. physical: 30 mm/s at 4 ms
  double turn_prior_rad = 0.004;  ///< and of its turn. physical: 1 rad/s at 4 ms
  /// chosen: by judgement. Spread of the projector's B2/B, in mode M of the code frame's gain.
  double shared_prior = 0.05;
  bool dense = true;  ///< mode T: the motion found is taken off by nodes twice as dense (motion_detail.hpp)
  /// chosen: by judgement. Of those asked, one in eight; fewer say nothing about six unknowns.
  std::size_t min_pixels = 600;
  /// chosen: by judgement. The second sees slopes without the ripple that the first took off; 0: none.
  int passes = 2;
  /// chosen: by judgement. A burst in which under a quarter of the blocks change faster counts as still.
  float negligible_rad = 0.002F;
};

struct RigidMotion {
  std::array<double, 3> shift_mm{};  ///< V, per frame interval
  std::array<double, 3> turn_rad{};  ///< W, per frame interval, about the optical axis' point at mid-range
  double about_mm = 0;               ///< depth of that point
  bool moved = false;                ///< determined
};

struct RigidMotionWork {
  MotionSamples samples;
  MotionImages images;
  MotionColumns columns;
  MotionNodes nodes;
  MotionDetailWork detail;
};

/// Nothing worth an estimate happened during the burst: of the blocks that say something, under a quarter changes
/// faster than negligible_rad and twice its own sigma. Texture that slides by on a surface without slope goes unseen.
[[nodiscard]] bool stands_still(std::span<const float> block_motion_rad, std::span<const float> block_sigma_rad,
                                float negligible_rad);

/// Whether a burst whose blocks show this is asked for a rigid motion.
[[nodiscard]] inline bool shows_motion(std::span<const float> block_motion_rad, std::span<const float> block_sigma_rad,
                                       const RigidMotionConfig& config) {
  return config.passes > 0 && !stands_still(block_motion_rad, block_sigma_rad, config.negligible_rad);
}

/// What a MotionView sees, phases as they were measured. Borrowed.
struct MovingSurface {
  const PhaseMaps& maps;
  const Map<std::int16_t>& wraps;
  const RayDepth& rays;
};

/// Slopes are those of the surface less the motion of the blocks, and in each pass after the first less that which the
/// pass before found. On moved, `field` holds the motion of the last pass; where the surface's slope is unknown, the
/// blocks' own rate, or that of a surface that faces the camera. config.passes >= 1.
[[nodiscard]] RigidMotion fit_rigid_motion(MotionView& view, const MovingSurface& surface,
                                           const RigidMotionConfig& config, RigidMotionWork& work, MotionField& field);

}  // namespace enamel::pipeline
