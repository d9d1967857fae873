// Zero surface of a field as triangles: surface nets (Gibson 1998) on a sparse grid, vertices then moved onto the field
// by Newton steps. Deterministic for any number of threads.
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

struct PolygoniseConfig {
  Eigen::Vector3d low, high;  ///< box to search
  double cell_mm = 0.065;
  double lipschitz = 1.9;  ///< bound of |grad field|: what lets far blocks be skipped
};

/// `field` < 0 inside; called from several threads. `keep` says whether the surface is wanted at a point: the result is
/// open where it ends. Albedo is left to the caller (set to 0.8).
[[nodiscard]] TriSurface polygonise(const PolygoniseConfig& config,
                                    const std::function<double(const Eigen::Vector3d&)>& field,
                                    const std::function<bool(const Eigen::Vector3d&)>& keep);

}  // namespace enamel::twin
