// A view while it is drawn: points and gradients with one array a coordinate, and the normals made of them. Private to
// model/fuse.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// Row-major with a rim of one pixel all round, which stays empty. Model frame; x of a point is NaN where there is
/// none.
struct ViewPlanes {
  /// Empties all pixels. Memory is kept.
  void clear(int view_width, int view_height);
  [[nodiscard]] std::size_t index(int i, int j) const noexcept {
    return static_cast<std::size_t>(j + 1) * stride + static_cast<std::size_t>(i + 1);
  }
  void put(int i, int j, const Vec3f& point, const Vec3f& gradient) {
    const std::size_t at = index(i, j);
    x[at] = point.x(), y[at] = point.y(), z[at] = point.z();
    gx[at] = gradient.x(), gy[at] = gradient.y(), gz[at] = gradient.z();
  }

  static constexpr std::size_t kLanes = 8;
  int width = 0, height = 0;
  std::size_t stride = 0;  ///< elements a row
  std::vector<float> x, y, z, gx, gy, gz;
  std::vector<float> nx, ny, nz;  ///< of one row, without rim, in eights: scratch
};

/// Unit normals from the gradients of the 3 x 3 neighbours on the same surface: the gradient of a trilinear interpolant
/// jumps between voxels, the mean over about one voxel does not. NaN where there is no point. normals: of the view's
/// size.
void smooth_normals(ViewPlanes& planes, Map<Vec3f>& normals);

}  // namespace enamel::pipeline
