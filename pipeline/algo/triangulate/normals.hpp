// Surface normals of an organised depth map: least-squares plane through antisymmetric pixel pairs. On a plane 1/z is
// exactly linear over the image, so the fit is made there and needs no iteration.
#pragma once

#include <vector>

#include "pipeline/algo/triangulate/ray_depth.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::algo {

struct NormalConfig {
  float max_slope_deg = 75;  ///< a steeper step between two pixels is a depth edge: the pair is left out
};

/// inverse_depth: 1/z, NaN = none. sigma_mm: of the depth. normals: unit, towards the camera; NaN where fewer than two
/// independent pairs lie on one surface. Pure; `scratch` keeps its memory between calls.
void compute_normals(const RayDepth& rays, const Map<float>& inverse_depth, const Map<float>& sigma_mm,
                     const NormalConfig& config, std::vector<float>& scratch, Map<Vec3f>& normals);

}  // namespace enamel::algo
