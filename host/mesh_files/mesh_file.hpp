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

/// A mesh with what else its file says of each vertex, by the file's names (PLY only; for example "seen", "red").
struct MeshFile {
  Mesh mesh;
  std::map<std::string, std::vector<float>> vertex_values;
};

enum class MeshFormat { kPly, kStl, kObj };

/// By the extension .ply .stl .obj in any case. Errors: kMeshInvalid for another one.
[[nodiscard]] Result<MeshFormat> mesh_format(const std::string& path);

/// PLY: ascii or binary little endian; faces with more than three corners are cut into fans. STL: binary or ascii;
/// equal positions become one vertex. OBJ: v, vn (where f uses v//vn with equal indices), f. A mesh has at least one
/// triangle. Errors: kMeshInvalid with the reason: truncated, not a number or infinite, index out of range, empty,
/// another format.
[[nodiscard]] Result<MeshFile> parse_mesh(std::string_view bytes, MeshFormat format);

/// Errors: kFileNotFound, kFileRead and those of mesh_format and parse_mesh (with the path).
[[nodiscard]] Result<MeshFile> read_mesh(const std::string& path);

using VertexColours = std::vector<std::array<std::uint8_t, 3>>;

/// Binary little endian: vertex x y z, nx ny nz and quality where the mesh has them, red green blue where given.
/// colours: empty or one a vertex.
[[nodiscard]] std::string ply_bytes(const Mesh& mesh, const VertexColours& colours = {});
/// Binary STL; facet normals from the corners.
[[nodiscard]] std::string stl_bytes(const Mesh& mesh);
[[nodiscard]] std::string obj_text(const Mesh& mesh);

/// Format by extension; the file appears whole or not at all. Errors: kMeshInvalid (extension), kFileWrite.
[[nodiscard]] Result<void> write_mesh(const std::string& path, const Mesh& mesh);

}  // namespace enamel::host
