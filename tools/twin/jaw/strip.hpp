// The strip about an arch that is meshed.
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "tools/twin/jaw/jaw_field.hpp"
#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

struct Strip {
  static constexpr double kNowhereBehind = -1e9;

  double from, to;               ///< arc length
  double inside, outside;        ///< widths
  double low, high;              ///< z
  double back = kNowhereBehind;  ///< y behind which nothing is kept

  /// How far out of the strip, > 0 outside.
  [[nodiscard]] double beyond(const ArchCoordinates::At& a, const Eigen::Vector3d& p) const;
};

/// What of the surface to mesh and how finely.
struct MeshLimits {
  double max_edge_mm;
  double lipschitz;  ///< bound of |grad field|
};

/// Zero surface of `field` (< 0 inside) within the strip, open at its borders. Edges may still be longer than
/// max_edge_mm here and there: refine_edges() once albedo is set.
[[nodiscard]] TriSurface mesh_strip(const Strip& strip, const Arch& arch, const ArchCoordinates& coordinates,
                                    const MeshLimits& limits,
                                    const std::function<double(const Eigen::Vector3d&)>& field);

}  // namespace enamel::twin
