// What meshing can be told.
#pragma once

#include <cstdint>

namespace enamel::pipeline {

struct MeshConfig {
  /// Largest difference of distance inside one cell, in voxels. A true distance changes by at most sqrt(3) there; more
  /// means that two surfaces meet in the cell, and what lies between them was not seen.
  double max_step_voxels = 3.0;
  double half_quality_weight = 8.0;             ///< fusion weight of quality 0.5
  std::uint32_t min_component_triangles = 200;  ///< smaller floating pieces are left out of the extracted mesh
};

}  // namespace enamel::pipeline
