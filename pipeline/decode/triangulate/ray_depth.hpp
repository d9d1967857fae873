// Depth along each camera ray as a function of absolute phase: 1/z is a cubic in Phi, fitted per pixel in double from
// the rig, its correction field included, and stored in float (docs/decode.md §7: 1/z is nearly linear in Phi, z is
// not). Phi = 2*pi*u_p / period_px, counted from projector pixel 0.
#pragma once

#include <cstddef>
#include <optional>

#include "calib/model/lens.hpp"
#include "calib/model/rig.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "protocol/base/staggered.hpp"

namespace enamel::pipeline {

/// 1/z = c0 + t*(c1 + t*(c2 + t*c3)), t = Phi - phase_mid_rad.
struct InverseDepthTable {
  StaggeredVector<float> phase_mid_rad, c0, c1, c2, c3;

  /// d(1/z)/dPhi.
  [[nodiscard]] float slope(std::size_t i, float phase_rad) const noexcept {
    const float t = phase_rad - phase_mid_rad[i];
    return c1[i] + t * (2 * c2[i] + t * (3 * c3[i]));
  }
};

/// Immutable after bake(), thread-safe. All arrays are row major of the camera's size.
struct RayDepth {
  int width = 0, height = 0;
  float near_mm = 0, far_mm = 0;
  calib::RayTable rays;
  Vec3f projector_mm = Vec3f::Zero();     ///< its centre, camera coordinates: where the light comes from
  Vec3f projector_axis = Vec3f::UnitZ();  ///< where its optical axis points, camera coordinates
  StaggeredVector<float> phase_mid_rad;   ///< Phi at the middle of the range in 1/z
  StaggeredVector<float> c0, c1, c2, c3;  ///< 1/z = c0 + t*(c1 + t*(c2 + t*c3)), t = Phi - phase_mid_rad
  /// Phi at near_mm by the parametric model, clipped to nothing: may lie outside the projector's frame
  StaggeredVector<float> phase_near_rad;
  StaggeredVector<float> phase_far_rad;
  InverseDepthTable sparse;  ///< of pixels (2x, 2y), row major, (width + 1)/2 a row
  float max_phase_rad = 0;   ///< Phi at the last edge of the projector's frame; the first edge is below
  float min_phase_rad = 0;

  /// Errors: kRigInvalid when some ray passes behind the projector, runs along its fringe planes, or Phi is not
  /// monotonic in depth over the range.
  [[nodiscard]] static Result<RayDepth> bake(const calib::Rig& rig, calib::DepthRange range);

  [[nodiscard]] float inverse_depth(std::size_t i, float phase_rad) const noexcept {
    const float t = phase_rad - phase_mid_rad[i];
    return c0[i] + t * (c1[i] + t * (c2[i] + t * c3[i]));
  }
  [[nodiscard]] float inverse_depth_slope(std::size_t i, float phase_rad) const noexcept {
    const float t = phase_rad - phase_mid_rad[i];
    return c1[i] + t * (2 * c2[i] + t * (3 * c3[i]));
  }
};

/// The exact form, the oracle of bake(): depth on the ray at which the rig's projector sees phase Phi, by Newton on the
/// forward projection, then the rig's correction. nullopt when it does not converge within (0, 10 * far_mm).
[[nodiscard]] std::optional<double> depth_by_iteration(const calib::Rig& rig, calib::PlanePoint ray, double phase_rad,
                                                       double start_mm);

}  // namespace enamel::pipeline
