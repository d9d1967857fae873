// Nearest point of a triangle soup: bounding-volume hierarchy, exact distance (Ericson, Real-Time Collision
// Detection, 5.1.5).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "pipeline/types/mesh.hpp"

namespace enamel::host {

/// Part of a triangle on which a nearest point lies.
enum class TriangleFeature : std::uint8_t { kVertex0, kVertex1, kVertex2, kEdge01, kEdge12, kEdge20, kFace };

struct Nearest {
  double distance_mm = 0;
  Vec3d point = Vec3d::Zero();
  std::uint32_t triangle = 0;
  TriangleFeature feature = TriangleFeature::kFace;
};

/// Nearest point of one triangle.
[[nodiscard]] Nearest nearest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// Immutable after construction; nearest() is thread-safe. The mesh must outlive the tree and have valid indices.
class TriangleTree {
 public:
  explicit TriangleTree(const Mesh& mesh);

  /// Nothing where no triangle is nearer than within_mm.
  [[nodiscard]] std::optional<Nearest> nearest(const Vec3d& p,
                                               double within_mm = std::numeric_limits<double>::infinity()) const;

 private:
  struct Node {
    Vec3d low, high;
    std::uint32_t first =
        0;  ///< leaf: first of order_; inner: index of the right child (the left one follows its parent)
    std::uint32_t count = 0;  ///< leaf: triangles; inner: 0
  };
  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  [[nodiscard]] static double distance2(const Node& node, const Vec3d& p);
  [[nodiscard]] Vec3d corner(std::uint32_t triangle, std::size_t k) const;

  const Mesh& mesh_;
  std::vector<Vec3d> centroids_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace enamel::host
