// A mesh as a picture: its vertices seen along its flattest direction.
#pragma once

#include <vector>

#include "host/mesh_files/mesh_file.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::host {

struct FlatMapSize {
  int width = 1200, height = 800, margin = 40;  ///< px
};

class FlatMap {
 public:
  /// The mesh must have vertices and outlive the map. The side of its normals looks to the viewer.
  explicit FlatMap(const Mesh& mesh, FlatMapSize size = {});

  /// Pixel and height towards the viewer (mm) of a point in the mesh's frame.
  [[nodiscard]] Vec3d project(const Vec3d& p_mm) const;
  [[nodiscard]] double px_per_mm() const noexcept { return scale_; }
  /// Of a direction in the mesh's frame, towards the viewer: 1 faces him.
  [[nodiscard]] double facing(const Vec3d& direction) const { return R_view_mesh_.row(2).dot(direction); }

  /// size.width x size.height pixels, row by row, three bytes each (blue, green, red); `colours` by vertex.
  [[nodiscard]] std::vector<std::uint8_t> drawn(const VertexColours& colours, std::uint8_t background) const;

 private:
  const Mesh& mesh_;
  FlatMapSize size_;
  Eigen::Matrix3d R_view_mesh_ = Eigen::Matrix3d::Identity();
  Vec3d centre_ = Vec3d::Zero();
  double scale_ = 1;  ///< px a mm
};

}  // namespace enamel::host
