// Signed distance to a triangle surface: sign by angle-weighted pseudo-normals (Baerentzen & Aanaes 2005), positive
// outside.
#pragma once

#include <array>
#include <vector>

#include "host/compare/triangle_tree.hpp"
#include "pipeline/types/mesh.hpp"

namespace enamel::host {

struct SignedDistance {
  double distance_mm = 0;  ///< positive outside
  Vec3d point = Vec3d::Zero();
  Vec3d normal = Vec3d::Zero();  ///< of the face hit, unit; zero for a triangle without area
  bool on_border = false;        ///< the nearest point lies on an open border of the surface
};

/// Corners of equal position count as one vertex, so pieces saved without shared vertices get the same signs.
class SignedSurface {
 public:
  explicit SignedSurface(Mesh mesh);
  SignedSurface(const SignedSurface&) = delete;
  SignedSurface& operator=(const SignedSurface&) = delete;

  [[nodiscard]] const Mesh& mesh() const noexcept { return mesh_; }
  [[nodiscard]] SignedDistance distance(const Vec3d& p) const;

 private:
  void weld();
  void sum_vertex_normals();
  void sum_edge_normals();

  Mesh mesh_;
  TriangleTree tree_;
  std::vector<std::uint32_t> welded_;  ///< first vertex of the same position
  std::vector<Vec3d> face_normal_, vertex_normal_;
  std::vector<std::array<Vec3d, 3>> edge_normal_;  ///< of edges 01, 12, 20
  std::vector<std::array<bool, 3>> edge_open_;
  std::vector<bool> vertex_open_;
};

}  // namespace enamel::host
