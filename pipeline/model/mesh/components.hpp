// Connected pieces of a mesh.
#pragma once

#include <cstdint>

#include "pipeline/types/mesh.hpp"

namespace enamel::pipeline {

struct ComponentStats {
  std::uint32_t components = 0;  ///< before
  std::uint32_t removed = 0;
  std::uint64_t triangles_removed = 0;
};

/// Removes pieces (triangles connected through shared vertices) of fewer than min_triangles, and vertices that no
/// triangle uses. Keeps the order of the rest.
ComponentStats remove_small_components(Mesh& mesh, std::uint32_t min_triangles);

}  // namespace enamel::pipeline
