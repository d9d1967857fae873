// What a reader found in a file, and the judgement that makes a mesh of it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host/mesh_files/mesh_file.hpp"
#include "pipeline/types/geometry.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

/// Positions in mm as the file says, finite or not. normals, quality and each of vertex_values: empty or one a
/// position.
struct MeshSoup {
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;
  std::vector<float> quality;
  std::map<std::string, std::vector<float>> vertex_values;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< every corner is a position's index
  std::vector<std::uint8_t> synthetic;                  ///< empty or one a triangle: MeshFile::synthetic
  std::uint64_t short_faces = 0;                        ///< with fewer than three corners, not among the triangles
  bool floats = false;                                  ///< the file keeps positions in single precision

  std::size_t tagged = 0;  ///< triangles that tag_synthetic() has seen

  struct Fan {
    std::size_t first = 0, count = 0;  ///< among the triangles
  };
  std::vector<Fan> fans;  ///< faces of more than three corners

  /// A face of any number of corners, as a fan until all positions are known.
  void add_face(const std::vector<std::uint32_t>& corners);
  /// All triangles since the last call.
  void tag_synthetic(bool made_up);
};

/// Leaves out and counts what is no surface, moves what lies far from the origin (MeshFile::origin_mm), rounds to
/// float. Errors: kMeshInvalid when no triangle remains.
[[nodiscard]] Result<MeshFile> finish_mesh(MeshSoup soup, const std::string& format);

}  // namespace enamel::host
