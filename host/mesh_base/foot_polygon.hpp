// The outline of a base: a border's shadow on a plane, made a polygon that does not cross itself, and its triangles.
// Private to host/mesh_base.
#pragma once

#include <cstdint>
#include <vector>

#include "host/mesh_base/edges.hpp"

namespace enamel::host {

using Vec2d = Eigen::Vector2d;

[[nodiscard]] double signed_area(const std::vector<Vec2d>& polygon);

struct FootPolygon {
  std::vector<Vec2d> points;  ///< simple, counter-clockwise
  std::vector<std::uint32_t>
      of;                       ///< for each point of the shadow that of `points` which stands for it; never backwards
  std::uint64_t crossings = 0;  ///< that were cut off
};

/// Where the shadow crosses itself, the part of smaller area is cut off: its points become the crossing. Fewer than
/// three points are left of a shadow that runs clockwise.
[[nodiscard]] FootPolygon uncrossed(const std::vector<Vec2d>& shadow);

/// Ears cut off one by one, the best shaped first (Meisters 1975): counter-clockwise triangles of a simple polygon's
/// indices, always size - 2. `folded`: of a polygon that is not simple after all, triangles that lie upon others.
struct Ears {
  std::vector<Triangle> triangles;
  std::uint64_t folded = 0;
};
[[nodiscard]] Ears cut_ears(const std::vector<Vec2d>& polygon);

}  // namespace enamel::host
