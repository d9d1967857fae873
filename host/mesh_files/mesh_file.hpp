// Triangle meshes as files: PLY, STL, OBJ. Lengths mm. Readers never trust a count, an index or a number of the file.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/types/mesh.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

/// What a file holds beside the surface and readers leave out.
struct LeftOut {
  std::uint64_t unused_vertices = 0;  ///< that no face left in names
  std::uint64_t broken_vertices = 0;  ///< a coordinate that is no finite number, or farther than 1 km from the others
  std::uint64_t broken_faces = 0;     ///< with such a corner
  std::uint64_t flat_faces = 0;       ///< no area, or fewer than three corners
  std::uint64_t synthetic_faces = 0;  ///< made up, not measured: leave_out_synthetic()
  bool normals = false;               ///< all of them: some are no finite numbers
};

/// "40 vertices that no face uses, 2 faces without area"; empty when nothing was left out.
[[nodiscard]] std::string left_out_text(const LeftOut& left_out);

/// A mesh with what else its file says of each vertex, by the file's names (PLY only; for example "seen", "red").
/// Every vertex is a corner of a triangle, every triangle has an area.
struct MeshFile {
  Mesh mesh;
  std::map<std::string, std::vector<float>> vertex_values;
  /// The file's positions, mm, are vertices + origin_mm. Not 0 only for a mesh whose median lies farther out than 1 m
  /// along some axis: read as double, moved, then rounded to float.
  Vec3d origin_mm = Vec3d::Zero();
  double step_mm = 0;  ///< where origin_mm is not 0: the step of the file's numbers there; 0: none seen
  LeftOut left_out;
  /// Empty, or one a triangle: 1 where the file says that it was made up, not measured (PLY: property `synthetic` of
  /// faces; OBJ: group `synthetic`).
  std::vector<std::uint8_t> synthetic = {};
};

/// Takes out what was made up, counted in `left_out`: measurements are of what was measured. Errors: kMeshInvalid where
/// nothing else is left.
[[nodiscard]] Result<MeshFile> leave_out_synthetic(MeshFile file);

enum class MeshFormat { kPly, kStl, kObj };

/// By the extension .ply .stl .obj in any case. Errors: kMeshInvalid for another one.
[[nodiscard]] Result<MeshFormat> mesh_format(const std::string& path);

/// PLY: ascii, binary of either byte order, faces and triangle strips. STL: text or binary, told apart by what they
/// say; equal positions become one vertex. OBJ: v, vn (where every corner of f is v//vn with equal indices), f.
/// Polygons are cut into fans. Texts may have a byte order mark, any line ends and decimal commas. Errors: kMeshInvalid
/// with the reason: truncated, not a number, index out of range, another format, or no triangle left after what is left
/// out.
[[nodiscard]] Result<MeshFile> parse_mesh(std::string_view bytes, MeshFormat format);

/// Errors: kFileNotFound, kFileRead and those of mesh_format and parse_mesh (with the path).
[[nodiscard]] Result<MeshFile> read_mesh(const std::string& path);
/// As read_mesh, without what was made up.
[[nodiscard]] Result<MeshFile> read_measured_mesh(const std::string& path);

using VertexColours = std::vector<std::array<std::uint8_t, 3>>;

/// Binary little endian: vertex x y z, nx ny nz, quality and soft_tissue (1: gum, tongue, cheek) where the mesh has
/// them, red green blue where given.
/// colours: empty or one a vertex. With an origin the positions are vertices + origin_mm, as double.
[[nodiscard]] std::string ply_bytes(const Mesh& mesh, const VertexColours& colours = {},
                                    const Vec3d& origin_mm = Vec3d::Zero());
/// Binary STL; facet normals from the corners.
[[nodiscard]] std::string stl_bytes(const Mesh& mesh);
/// Groups `hard` and `soft_tissue` where the mesh tells them apart.
[[nodiscard]] std::string obj_text(const Mesh& mesh);

/// Format by extension; the file appears whole or not at all. Errors: kMeshInvalid (extension), kFileWrite.
[[nodiscard]] Result<void> write_mesh(const std::string& path, const Mesh& mesh);

}  // namespace enamel::host
