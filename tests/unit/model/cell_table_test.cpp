// Marching cubes' table: any field's surface is closed and faces outwards.
#include "pipeline/model/mesh/cell_table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <vector>

#include "tests/unit/model/mesh_checks.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::pipeline {
namespace {

/// Marching cubes over a dense random field through cell_table alone.
Mesh mesh_of_random_field(std::uint64_t seed, int n) {
  synthetic::Random random(seed);
  std::vector<double> field(static_cast<std::size_t>(n * n * n), 1.0);
  const auto at = [n](int x, int y, int z) { return static_cast<std::size_t>(x + n * (y + n * z)); };
  for (int z = 1; z < n - 1; ++z) {
    for (int y = 1; y < n - 1; ++y) {
      for (int x = 1; x < n - 1; ++x) {
        field[at(x, y, z)] = random.normal();  // outside all around, anything within
      }
    }
  }
  Mesh mesh;
  std::map<std::array<int, 4>, std::uint32_t> vertex;
  for (int cell = 0; cell < (n - 1) * (n - 1) * (n - 1); ++cell) {
    const std::array<int, 3> c{cell % (n - 1), (cell / (n - 1)) % (n - 1), cell / ((n - 1) * (n - 1))};
    unsigned inside = 0;
    for (int k = 0; k < 8; ++k) {
      inside |= (field[at(c[0] + (k & 1), c[1] + ((k >> 1) & 1), c[2] + (k >> 2))] < 0 ? 1U : 0U)
                << static_cast<unsigned>(k);
    }
    for (const auto& triangle : cell_table()[inside]) {
      std::array<std::uint32_t, 3> t{};
      for (std::size_t k = 0; k < 3; ++k) {
        const int lower = kCellEdge[triangle[k]][0];
        const std::array<int, 4> key{c[0] + (lower & 1), c[1] + ((lower >> 1) & 1), c[2] + (lower >> 2),
                                     triangle[k] / 4};
        const auto found = vertex.try_emplace(key, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (found.second) {
          Vec3f p(static_cast<float>(key[0]), static_cast<float>(key[1]), static_cast<float>(key[2]));
          p[key[3]] += 0.5F;
          mesh.vertices.push_back(p);
        }
        t[k] = found.first->second;
      }
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

TEST(CellTable, random_fields_give_closed_oriented_manifold_surfaces) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Mesh mesh = mesh_of_random_field(seed, 12);
    ASSERT_GT(mesh.triangles.size(), 1000U);
    EXPECT_EQ(open_or_crowded_edges(mesh), 0U) << seed;
  }
}

TEST(CellTable, one_inside_corner_faces_outwards) {
  const auto& triangles = cell_table()[1];  // inside: corner (0, 0, 0)
  ASSERT_EQ(triangles.size(), 1U);
  const auto middle = [](std::uint8_t edge) -> Vec3d {
    const auto corner = [](int c) { return Vec3d(c & 1, (c >> 1) & 1, c >> 2); };
    return 0.5 * (corner(kCellEdge[edge][0]) + corner(kCellEdge[edge][1]));
  };
  const auto& t = triangles[0];
  const Vec3d n = (middle(t[1]) - middle(t[0])).cross(middle(t[2]) - middle(t[0]));
  EXPECT_GT(n.dot(Vec3d::Ones()), 0.0);
}

}  // namespace
}  // namespace enamel::pipeline
