// A pixel's place on its ray. Private to model/guide.
#pragma once

#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// Whether 1/z lies within the depth range.
[[nodiscard]] inline bool in_range(const RayDepth& rays, float q) {
  return q * rays.near_mm <= 1 && q * rays.far_mm >= 1;
}

/// Camera coordinates at depth z, mm.
[[nodiscard]] inline Vec3f point_at(const RayDepth& rays, std::size_t i, float z) {
  return {rays.rays.x[i] * z, rays.rays.y[i] * z, z};
}

}  // namespace enamel::pipeline
