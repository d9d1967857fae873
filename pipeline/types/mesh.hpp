// Indexed triangle mesh, mm. Triangles wind counter-clockwise seen from outside.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel {

struct Mesh {
  std::vector<Vec3f> vertices;
  std::vector<Vec3f> normals;  ///< empty or one a vertex, unit, outwards
  std::vector<float> quality;  ///< empty or one a vertex, 0 (seen once, steep) … 1 (seen often, facing)
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint8_t> soft = {};  ///< empty (nothing is) or one a vertex: 1 on soft tissue
};

}  // namespace enamel
