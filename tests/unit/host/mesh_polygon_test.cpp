// Faces of more than three corners.
#include <gtest/gtest.h>

#include <cmath>

#include "host/mesh_files/mesh_file.hpp"

namespace enamel::host {
namespace {

TEST(MeshPolygon, polygons_of_any_size_become_triangles) {
  std::string obj,
      ply =
          "ply\nformat ascii 1.0\nelement vertex 2000\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list int int vertex_indices\nend_header\n";
  std::string face = "f", list = "2000";
  for (int k = 0; k < 2000; ++k) {
    const double angle = 2 * M_PI * k / 2000;
    const std::string p = std::to_string(9 * std::cos(angle)) + " " + std::to_string(9 * std::sin(angle)) + " 1\n";
    obj += "v " + p;
    ply += p;
    face += " " + std::to_string(k + 1);
    list += " " + std::to_string(k);
  }
  for (const auto& file : {parse_mesh(obj + face, MeshFormat::kObj), parse_mesh(ply + list, MeshFormat::kPly)}) {
    ASSERT_TRUE(file.has_value()) << file.error().detail;
    EXPECT_EQ(file->mesh.triangles.size(), 1998U);
  }
}

/// Area of what is folded over counts twice.
double area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]].cast<double>();
    sum += 0.5 * (mesh.vertices[t[1]].cast<double>() - a).cross(mesh.vertices[t[2]].cast<double>() - a).norm();
  }
  return sum;
}

TEST(MeshPolygon, polygons_with_dents_are_not_folded_over) {
  const std::pair<const char*, double> faces[] = {
      {"v 0 0 1\nv 10 0 1\nv 2 2 1\nv 0 10 1\nf 4 1 2 3\n", 20},  // an arrow's head, from every corner
      {"v 0 0 1\nv 10 0 1\nv 2 2 1\nv 0 10 1\nf 1 2 3 4\n", 20},
      {"v 0 0 1\nv 10 0 1\nv 2 2 1\nv 0 10 1\nf 2 3 4 1\n", 20},
      {"v 0 0 1\nv 10 0 1\nv 2 2 1\nv 0 10 1\nf 2 1 4 3\n", 20},  // the other way round
      {"f 1 2 3 4 5 6 7 8\nv 0 0 0\nv 0 9 0\nv 0 9 9\nv 0 6 9\nv 0 6 3\nv 0 3 3\nv 0 3 9\nv 0 0 9\n", 63},  // a U
      {"v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nv 3 3 0\nv 3 6 0\nv 6 6 0\nv 6 3 0\nf 1 2 3 4 1 5 6 7 8 5\n",
       72},                                                                // a hole
      {"v 0 0 0\nv 5 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nf 2 3 4 5 1\n", 81},  // a corner on an edge
  };
  for (const auto& [text, expected_area] : faces) {
    const auto file = parse_mesh(text, MeshFormat::kObj);
    ASSERT_TRUE(file.has_value()) << file.error().detail;
    EXPECT_NEAR(area(file->mesh), expected_area, 1e-4) << text;
    EXPECT_EQ(left_out_text(file->left_out), "") << text;
  }
  // Control: one that crosses itself stays a fan.
  EXPECT_EQ(parse_mesh("v 0 0 0\nv 9 0 0\nv 0 9 0\nv 9 9 0\nf 1 2 3 4\n", MeshFormat::kObj)->mesh.triangles.size(), 2U);
}

}  // namespace
}  // namespace enamel::host
