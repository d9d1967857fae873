#include "pipeline/decode/triangulate/inverse_depth.hpp"

#include "pipeline/decode/triangulate/inverse_depth_rows.hpp"

namespace enamel::pipeline {

InverseDepthRange depth_range_of(const RayDepth& rays, float beyond) noexcept {
  return {(1 + beyond) / rays.near_mm, (1 - beyond) / rays.far_mm, rays.min_phase_rad, rays.max_phase_rad};
}

void sparse_inverse_depth_row(const SparseDepth& of, int v, const float* phase_rad, float* inverse_depth) {
  const std::size_t count = static_cast<std::size_t>(of.rays.width + 1) / 2;
  const std::size_t first = static_cast<std::size_t>(v / 2) * count, at = of.maps.phase_rad.index(0, v);
  const InverseDepthTable& t = of.rays.sparse;
  inverse_depth_row({phase_rad, &t.phase_mid_rad[first], &t.c0[first], &t.c1[first], &t.c2[first], &t.c3[first],
                     &of.wraps[at], &of.maps.reject[at]},
                    depth_range_of(of.rays, of.beyond), count, inverse_depth);
}

}  // namespace enamel::pipeline
