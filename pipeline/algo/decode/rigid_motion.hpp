// How the probe moved during the burst: the closure residual of all pixels, explained by one rigid motion. Six unknowns
// for a whole image see through noise and curvature that a patch of the image cannot (algorithms.md §9).
//
// Frame of reference: camera, mm, rad; all motion is of the surface seen from the camera, per frame interval. With the
// tangent plane m.P = 1 at a pixel (m = n/d, 1/z = q = m.r, r = (x, y, 1)) and the point's motion U = V + W x (P - P0),
// with shift V and turn W about the middle P0 of the measuring volume:
//   dq = -q m.U                      rate of the phase at the pixel  eps = dq / (dq/dPhi)
//   (dx, dy) = (Ux - x Uz, Uy - y Uz) q      image motion
//   light: dA = -grad A . image motion - 2 (A - black) Uz q     texture passes by; light falls off with distance
// The modulation is taken to change as the light does: dB/B = dA/(A - black).
#pragma once

#include <array>
#include <vector>

#include "pipeline/algo/phase/closure.hpp"
#include "pipeline/algo/triangulate/ray_depth.hpp"

namespace enamel::algo {

struct RigidMotionConfig {
  float max_residual = 0.6F;      ///< of B; beyond it the pixel sees an edge or a glint, not motion
  float outlier_sigmas = 4;       ///< second round: residuals beyond this many rms are left out
  double shift_prior_mm = 0.12;   ///< spread of a hand's shift per frame: 30 mm/s at 4 ms
  double turn_prior_rad = 0.004;  ///< and of its turn: 1 rad/s
  double harmonic_prior = 0.05;   ///< spread of the projector's B2/B
  std::size_t min_pixels = 600;   ///< of those asked, one in eight; fewer say nothing about six unknowns
  float min_block_pixels = 100;   ///< blocks with fewer are not asked whether anything moved
  float negligible_rad = 0.002F;  ///< a burst in which under a quarter of the blocks change faster counts as still
};

struct RigidMotion {
  std::array<double, 3> shift_mm{};  ///< V, per frame interval
  std::array<double, 3> turn_rad{};  ///< W, per frame interval, about the optical axis' point at mid-range
  double about_mm = 0;               ///< depth of that point
  bool moved = false;                ///< determined
};

struct RigidMotionWork {
  struct Node {
    bool ok = false;    ///< slope known
    bool fits = false;  ///< and well enough to estimate the motion from
    std::array<float, 6> rate{}, light{};
  };
  std::vector<Node> nodes;
  std::vector<float> node_rate, node_light;
  Map<float> light;
};

/// Nothing worth an estimate happened during the burst. Texture that slides by on a surface without slope goes unseen.
[[nodiscard]] bool stands_still(const ClosureFit& coarse, const RigidMotionConfig& config);

/// Inputs after apply_polarity: c, s, B, residual, weights; `coarse`, the block-wise estimate. inverse_depth: of the
/// burst as corrected so far. The image of A is cleaned from the ripple of the motion known so far: that of `coarse`,
/// or, with `refine`, that of `field` and `work` from the call before. On moved, `field` holds the motion at every
/// pixel; where the surface's slope is unknown, the blocks' own rate.
[[nodiscard]] RigidMotion fit_rigid_motion(const PhaseMaps& maps, const PolarityMaps& polarity,
                                           const ClosureFit& coarse, const RayDepth& rays,
                                           const Map<float>& inverse_depth, float black_dn, bool refine,
                                           const RigidMotionConfig& config, RigidMotionWork& work, MotionField& field);

}  // namespace enamel::algo
