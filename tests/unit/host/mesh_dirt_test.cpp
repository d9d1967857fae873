// What is no surface is left out and counted; what lies far from the origin keeps its digits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "host/mesh_files/mesh_file.hpp"
#include "tests/unit/host/tetrahedron.hpp"

namespace enamel::host {
namespace {

using testing::HasSubstr;

TEST(MeshDirt, dirt_is_left_out_and_counted) {
  Mesh mesh = tetrahedron();
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  mesh.vertices.insert(mesh.vertices.begin(), Vec3f(nan, 0, 0));  // no face names it
  mesh.vertices.emplace_back(Vec3f(7, 7, 7));                     // nor this one
  mesh.vertices.emplace_back(Vec3f(0, inf, 0));
  mesh.vertices.emplace_back(Vec3f(6.25F, 0, 0));  // on an edge
  for (auto& t : mesh.triangles) t = {t[0] + 1, t[1] + 1, t[2] + 1};
  mesh.triangles.push_back({1, 2, 6});
  mesh.triangles.push_back({1, 1, 2});
  mesh.triangles.push_back({1, 2, 7});
  mesh.quality.assign(mesh.vertices.size(), 0.5F);
  mesh.quality[1] = 1.0F;
  const auto file = parse_mesh(ply_bytes(mesh), MeshFormat::kPly);
  ASSERT_TRUE(file.has_value()) << file.error().detail;
  EXPECT_EQ(soup_of(*file), expected());
  EXPECT_EQ(file->mesh.quality, (std::vector<float>{1.0F, 0.5F, 0.5F, 0.5F}));
  EXPECT_EQ(file->left_out.broken_vertices, 2U);
  EXPECT_EQ(file->left_out.unused_vertices, 2U);
  EXPECT_EQ(file->left_out.broken_faces, 1U);
  EXPECT_EQ(file->left_out.flat_faces, 2U);
  EXPECT_EQ(left_out_text(file->left_out),
            "2 vertices that no face uses, 2 vertices without a finite position, 1 face with such a corner, "
            "2 faces without area");
}

TEST(MeshDirt, dirt_as_text_is_left_out_and_counted) {
  const std::string v = "v 0 0 0\nv 12.5 0 0\nv 0 1.5e1 0\nv 0 0.25 -48.125\n";
  const std::string f = "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
  for (const char* bad : {"nan", "NaN", "-nan(ind)", "1.#QNAN", "-1.#IND", "inf", "-Infinity", "1e999", "1e30"}) {
    const auto file = parse_mesh(v + "v 0 " + bad + " 0\n" + f + "f 1 2 5\nf 1 2\nf 3\nf 1 2 2\n", MeshFormat::kObj);
    ASSERT_TRUE(file.has_value()) << bad << file.error().detail;
    EXPECT_EQ(soup_of(*file), expected()) << bad;
    EXPECT_EQ(file->left_out.broken_vertices, 1U) << bad;
    EXPECT_EQ(file->left_out.broken_faces, 1U) << bad;
    EXPECT_EQ(file->left_out.flat_faces, 3U) << bad;
  }
  std::string stl = stl_text();
  stl.insert(stl.find(" facet"),
             "facet normal nan nan nan\nouter loop\nvertex 1 1 1\nvertex 1 1 1\nvertex 2 2 2\nendloop\nendfacet\n"
             "facet normal 0 0 0\nouter loop\nvertex nan 1 1\nvertex 0 0 0\nvertex 12.5 0 0\nendloop\nendfacet\n");
  const auto file = parse_mesh(stl, MeshFormat::kStl);
  ASSERT_TRUE(file.has_value()) << file.error().detail;
  EXPECT_EQ(soup_of(*file), expected());
  EXPECT_EQ(file->left_out.flat_faces, 1U);
  EXPECT_EQ(file->left_out.broken_faces, 1U);
}

TEST(MeshDirt, a_mesh_of_nothing_but_dirt_is_refused_with_its_counts) {
  const auto file = parse_mesh("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 3\n", MeshFormat::kObj);
  ASSERT_FALSE(file.has_value());
  EXPECT_EQ(file.error().code, ErrorCode::kMeshInvalid);
  EXPECT_THAT(file.error().detail, HasSubstr("1 face with such a corner, 1 face without area"));
}

TEST(MeshDirt, normals_that_do_not_go_with_the_vertices_are_not_taken) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\n";
  EXPECT_EQ(parse_mesh(v + "f 1//1 2//2 3//3\n", MeshFormat::kObj)->mesh.normals.size(), 3U);
  EXPECT_TRUE(parse_mesh(v + "f 1//2 2//1 3//3\n", MeshFormat::kObj)->mesh.normals.empty());
  EXPECT_TRUE(parse_mesh(v + "f 1 2 3\n", MeshFormat::kObj)->mesh.normals.empty());
  Mesh mesh = tetrahedron();
  mesh.normals.assign(4, Vec3f(0, 0, std::numeric_limits<float>::quiet_NaN()));
  const auto file = parse_mesh(ply_bytes(mesh), MeshFormat::kPly);
  ASSERT_TRUE(file.has_value());
  EXPECT_TRUE(file->mesh.normals.empty());
  EXPECT_TRUE(file->left_out.normals);
}

std::string far_obj(double offset_mm, int digits) {
  std::string text;
  for (const auto& p : kCorners) {
    std::array<char, 200> line{};
    std::snprintf(line.data(), line.size(), "v %.*f %.*f %.*f\n", digits, offset_mm + p[0] + 0.1234567, digits,
                  p[1] - offset_mm + 0.7654321, digits, p[2] + 0.1111111);
    text += line.data();
  }
  return text + "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
}

TEST(MeshDirt, far_from_the_origin_nothing_is_lost) {
  for (const double offset : {0.0, 2e4, 7e5, 5.4e9}) {  // a desk, a hall, a town, a map's grid
    const auto file = parse_mesh(far_obj(offset, 7), MeshFormat::kObj);
    ASSERT_TRUE(file.has_value()) << file.error().detail;
    const auto& v = file->mesh.vertices;
    EXPECT_NEAR(static_cast<double>((v[1] - v[0]).x()), 12.5, 2e-6) << offset;
    EXPECT_NEAR(static_cast<double>(v[0].x()) + file->origin_mm.x() - offset, 0.1234567, 2e-6) << offset;
    EXPECT_EQ(file->origin_mm.isZero(0), offset == 0.0);
    EXPECT_EQ(file->origin_mm.z(), 0.0);
    EXPECT_EQ(file->step_mm, 0.0) << offset;
  }
}

TEST(MeshDirt, a_stray_vertex_does_not_move_the_origin) {
  const auto file =
      parse_mesh(far_obj(0, 7) + "v 900000 900000 900000\nv 900000 900000 900001\nf 1 5 6\n", MeshFormat::kObj);
  ASSERT_TRUE(file.has_value());
  EXPECT_TRUE(file->origin_mm.isZero(0));
}

TEST(MeshDirt, the_step_of_numbers_far_out_is_told) {
  EXPECT_NEAR(parse_mesh(far_obj(7e5, 2), MeshFormat::kObj)->step_mm, 0.01, 1e-12);
  EXPECT_NEAR(parse_mesh(far_obj(7e5, 0), MeshFormat::kObj)->step_mm, 1.0, 1e-12);
  Mesh mesh = tetrahedron();
  for (Vec3f& v : mesh.vertices) v += Vec3f(2.5e5F, 0, 0);
  EXPECT_EQ(parse_mesh(ply_bytes(mesh), MeshFormat::kPly)->step_mm, 0.015625);
  EXPECT_EQ(parse_mesh(stl_bytes(mesh), MeshFormat::kStl)->step_mm, 0.015625);
  // Doubles that were floats before.
  Mesh rough = tetrahedron();
  const Vec3d origin(250000.015625, 0, 0);
  for (Vec3f& v : rough.vertices) v.x() = std::round(v.x() * 64.0F) / 64.0F + (v.x() > 1 ? 0.015625F : 0.0F);
  EXPECT_EQ(parse_mesh(ply_bytes(rough, {}, origin), MeshFormat::kPly)->step_mm, 0.015625);
}

TEST(MeshDirt, a_mesh_far_out_is_written_where_it_was) {
  const auto file = parse_mesh(far_obj(7e5, 7), MeshFormat::kObj);
  ASSERT_TRUE(file.has_value());
  const auto back = parse_mesh(ply_bytes(file->mesh, {}, file->origin_mm), MeshFormat::kPly);
  ASSERT_TRUE(back.has_value()) << back.error().detail;
  EXPECT_EQ(back->mesh.vertices, file->mesh.vertices);
  EXPECT_EQ(back->origin_mm, file->origin_mm);
}

}  // namespace
}  // namespace enamel::host
