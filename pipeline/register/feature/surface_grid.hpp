// A patch thinned to a grid of surface elements, each with its own area: sums over them do not depend on the side that
// the surface was seen from.
#pragma once

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

struct GridConfig {
  double pitch_mm = 0.14;         ///< chosen: on facing surface; a third of the radius that bending is measured over
  double max_incidence_deg = 75;  ///< chosen: beyond, an element's area is known to half of itself only
};

/// Camera frame. area_mm2 is 0 where nothing is known; points and normals are zero there.
struct SurfaceGrid {
  Map<Vec3f> points;
  Map<Vec3f> normals;
  Map<float> area_mm2;
  float pitch_mm = 0;  ///< of facing surface at mid-depth
};

/// Block means of the patch. px_per_mm: camera pixels a millimetre on a facing surface at mid-depth. Pure.
[[nodiscard]] SurfaceGrid make_surface_grid(const SurfacePatch& patch, double px_per_mm, const GridConfig& config);

/// Bending (mean curvature, 1/mm, convex positive) over a ball: sum a (q-p).(n_q-n_p) / sum a |q-p|^2. NaN where less
/// than 0.7 of the disc is seen: there it would depend on what hides the rest.
[[nodiscard]] Map<float> bending(const SurfaceGrid& grid, double radius_mm);

}  // namespace enamel::pipeline
