// One tetrahedron, as other programs write it.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "host/mesh_files/mesh_file.hpp"

namespace enamel::host {

inline constexpr std::array<std::array<double, 3>, 4> kCorners{
    {{0, 0, 0}, {12.5, 0, 0}, {0, 1.5e1, 0}, {0, 0.25, -48.125}}};
inline constexpr std::array<std::array<std::uint32_t, 3>, 4> kFaces{{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};

/// The corners of every triangle, in order.
inline std::vector<Vec3d> soup_of(const MeshFile& file) {
  std::vector<Vec3d> out;
  for (const auto& t : file.mesh.triangles) {
    for (const std::uint32_t corner : t) out.emplace_back(file.mesh.vertices[corner].cast<double>() + file.origin_mm);
  }
  return out;
}

inline std::vector<Vec3d> expected() {
  std::vector<Vec3d> out;
  for (const auto& f : kFaces) {
    for (const std::uint32_t corner : f)
      out.emplace_back(kCorners[corner][0], kCorners[corner][1], kCorners[corner][2]);
  }
  return out;
}

inline std::string stl_text(const std::string& name = "a jaw of two words") {
  std::string text = "solid " + name + "\n";
  for (const auto& f : kFaces) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const std::uint32_t corner : f) {
      const auto& p = kCorners[corner];
      text += "   vertex " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
    }
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

inline Mesh tetrahedron() {
  Mesh mesh;
  for (const auto& p : kCorners) mesh.vertices.push_back(Vec3d(p[0], p[1], p[2]).cast<float>());
  mesh.triangles.assign(kFaces.begin(), kFaces.end());
  return mesh;
}

}  // namespace enamel::host
