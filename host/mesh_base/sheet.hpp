// A mesh made a clean surface with borders: what a base can be hung on. Private to host/mesh_base.
#pragma once

#include <cstdint>
#include <vector>

#include "host/mesh_base/edges.hpp"
#include "pipeline/types/mesh.hpp"

namespace enamel::host {

/// Vertices of a border in the order in which its faces run along it, each named once.
using Loop = std::vector<std::uint32_t>;

struct Sheet {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  std::uint64_t left_out_faces = 0;  ///< crowded edges, pinched vertices, faces given twice
};

/// Corners of equal position become one vertex. Left out is what keeps an edge from having two faces at most that run
/// against each other, and a vertex from having one fan: of two faces the later, of fans the smaller.
[[nodiscard]] Sheet clean_sheet(const Mesh& mesh);

/// Keeps the faces told and the vertices that they name.
void keep_faces(Sheet& sheet, const std::vector<bool>& kept);

/// All borders of a clean sheet, in order of their lowest vertex.
[[nodiscard]] std::vector<Loop> borders(const Sheet& sheet);

}  // namespace enamel::host
