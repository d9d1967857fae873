// The nearest triangle, against a search through all of them.
#include "host/compare/triangle_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/host/mesh_shapes.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::host {
namespace {

TEST(TriangleTree, finds_what_a_full_search_finds) {
  const Mesh mesh = relief(0.8).mesh;
  const TriangleTree tree(mesh);
  synthetic::Random random(4);
  for (int k = 0; k < 300; ++k) {
    const Vec3d p = random.vector().cwiseProduct(Vec3d(24, 16, 8));
    double best = 1e9;
    for (const auto& t : mesh.triangles) {
      best = std::min(best, nearest_on_triangle(p, mesh.vertices[t[0]].cast<double>(),
                                                mesh.vertices[t[1]].cast<double>(), mesh.vertices[t[2]].cast<double>())
                                .distance_mm);
    }
    ASSERT_TRUE(tree.nearest(p).has_value());
    EXPECT_DOUBLE_EQ(tree.nearest(p)->distance_mm, best);
    EXPECT_EQ(tree.nearest(p, best * 0.99).has_value(), false);
  }
}

TEST(TriangleTree, every_feature_of_a_triangle_is_exact) {
  const Vec3d a(0, 0, 0);
  const Vec3d b(2, 0, 0);
  const Vec3d c(0, 1, 0);
  const auto is = [&](const Vec3d& p, double distance, TriangleFeature feature) {
    const Nearest n = nearest_on_triangle(p, a, b, c);
    EXPECT_NEAR(n.distance_mm, distance, 1e-12);
    EXPECT_EQ(n.feature, feature);
  };
  is({-3, -4, 0}, 5, TriangleFeature::kVertex0);
  is({5, -4, 0}, 5, TriangleFeature::kVertex1);
  is({0, 3, 0}, 2, TriangleFeature::kVertex2);
  is({1, -2, 0}, 2, TriangleFeature::kEdge01);
  is({-2, 0.5, 0}, 2, TriangleFeature::kEdge20);
  is({2, 2, 0}, 4 / std::sqrt(5.0), TriangleFeature::kEdge12);
  is({0.2, 0.2, -7}, 7, TriangleFeature::kFace);
}

}  // namespace
}  // namespace enamel::host
