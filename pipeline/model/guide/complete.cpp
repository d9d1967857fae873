#include "pipeline/model/guide/complete.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "pipeline/model/guide/ray_point.hpp"

namespace enamel::pipeline {
namespace {

/// Whether the phase is on the projector and its depth in the range.
bool add_pixel(const RayDepth& rays, std::size_t i, float phase_rad, float sigma_rad, SurfacePatch& patch) {
  const float q = rays.inverse_depth(i, phase_rad);
  const bool inside = in_range(rays, q) && phase_rad > rays.min_phase_rad && phase_rad < rays.max_phase_rad;
  if (!inside) return false;
  const float z = 1 / q;
  patch.depth_mm[i] = z;
  patch.sigma_mm[i] = z * z * std::abs(rays.inverse_depth_slope(i, phase_rad)) * sigma_rad;
  patch.points[i] = point_at(rays, i, z);
  return true;
}

}  // namespace

std::size_t add_decided(const RelativeSurface& relative, std::span<const std::int32_t> orders, const RayDepth& rays,
                        const NormalConfig& config, SurfacePatch& patch) {
  std::size_t added = 0, n = 0;
  for (const auto& span : relative.spans) {
    const std::size_t at = patch.depth_mm.index(0, span.row);
    for (std::int32_t u = span.begin; u < span.end; ++u, ++n) {
      if (orders[n] == kOpenOrder) continue;
      const float wrap_counts = 2 * std::numbers::pi_v<float> * static_cast<float>(span.wraps + orders[n]);
      added += add_pixel(rays, at + static_cast<std::size_t>(u), relative.phase_rad[n] + wrap_counts,
                         relative.sigma_rad[n], patch)
                   ? 1U
                   : 0U;
    }
  }
  if (added == 0) return 0;
  patch.valid_px += added;
  Map<float> inverse_depth(rays.width, rays.height);
  for (std::size_t i = 0; i < inverse_depth.size(); ++i) inverse_depth[i] = 1 / patch.depth_mm[i];
  std::vector<float> scratch;
  compute_normals(rays, inverse_depth, patch.sigma_mm, config, scratch, patch.normals);
  return added;
}

}  // namespace enamel::pipeline
