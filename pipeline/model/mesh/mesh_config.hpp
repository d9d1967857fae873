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
  std::uint32_t passing_bursts = 24;            ///< chosen: so short a while; a body that passed was seen no longer …
  std::uint32_t passing_triangles = 8000;  ///< chosen: … floating pieces as small, 25 mm², are then left out too
};

}  // namespace enamel::pipeline
