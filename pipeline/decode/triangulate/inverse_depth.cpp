#include "pipeline/decode/triangulate/inverse_depth.hpp"

#include "pipeline/decode/triangulate/inverse_depth_rows.hpp"

namespace enamel::pipeline {

InverseDepthRange depth_range_of(const RayDepth& rays, float beyond) noexcept {
  return {(1 + beyond) / rays.near_mm, (1 - beyond) / rays.far_mm, rays.min_phase_rad, rays.max_phase_rad};
}

void sparse_inverse_depth_row(const PhaseMaps& maps, const Map<std::int16_t>& turn, const RayDepth& rays, float beyond,
                              int v, const float* phase_rad, float* inverse_depth) {
  const std::size_t count = static_cast<std::size_t>(rays.width + 1) / 2, of = static_cast<std::size_t>(v / 2) * count;
  const std::size_t at = maps.phase_rad.index(0, v);
  const InverseDepthTable& t = rays.sparse;
  inverse_depth_row(
      {phase_rad, &t.phase_mid_rad[of], &t.c0[of], &t.c1[of], &t.c2[of], &t.c3[of], &turn[at], &maps.reject[at]},
      depth_range_of(rays, beyond), count, inverse_depth);
}

}  // namespace enamel::pipeline
