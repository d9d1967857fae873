// Mesh and pose files: round trips, and refusal of what is damaged.
#include "host/mesh_files/mesh_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <limits>

#include "host/mesh_files/poses_csv.hpp"
#include "protocol/base/file.hpp"

namespace enamel::host {
namespace {

using testing::HasSubstr;

Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1.25F, 0, 0}, {0, 1.5F, 0}, {0, 0, -48.125F}};
  mesh.normals = {{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  mesh.quality = {0.0F, 0.25F, 0.5F, 1.0F};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  return mesh;
}

std::string reason(const Result<MeshFile>& result) {
  EXPECT_FALSE(result.has_value());
  if (result) {
    return "accepted";
  }
  EXPECT_EQ(result.error().code, ErrorCode::kMeshInvalid);
  return result.error().detail;
}

TEST(MeshFile, ply_keeps_everything_bit_for_bit) {
  const Mesh mesh = tetrahedron();
  const auto back = parse_mesh(ply_bytes(mesh), MeshFormat::kPly);
  ASSERT_TRUE(back.has_value()) << back.error().detail;
  EXPECT_EQ(back->mesh.vertices, mesh.vertices);
  EXPECT_EQ(back->mesh.normals, mesh.normals);
  EXPECT_EQ(back->mesh.quality, mesh.quality);
  EXPECT_EQ(back->mesh.triangles, mesh.triangles);
  EXPECT_TRUE(back->vertex_values.empty());
}

TEST(MeshFile, colours_are_kept_under_their_names) {
  const auto back = parse_mesh(ply_bytes(tetrahedron(), VertexColours(4, {1, 2, 255})), MeshFormat::kPly);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->vertex_values.at("blue"), std::vector<float>(4, 255.0F));
}

TEST(MeshFile, soft_tissue_is_told_by_a_property_or_a_group) {
  Mesh mesh = tetrahedron();
  EXPECT_EQ(ply_bytes(mesh).find("soft_tissue"), std::string::npos) << "control";
  EXPECT_EQ(obj_text(mesh).find("\ng "), std::string::npos) << "control";
  mesh.soft = {1, 1, 0, 1};
  const auto back = parse_mesh(ply_bytes(mesh), MeshFormat::kPly);
  ASSERT_TRUE(back.has_value()) << back.error().detail;
  EXPECT_EQ(back->mesh.soft, mesh.soft);
  EXPECT_TRUE(back->vertex_values.empty());
  const std::string text = obj_text(mesh);
  EXPECT_NE(text.find("\ng soft_tissue\n"), std::string::npos);
  const auto again = parse_mesh(text, MeshFormat::kObj);
  ASSERT_TRUE(again.has_value()) << again.error().detail;
  EXPECT_EQ(again->mesh.triangles, mesh.triangles) << "all faces are kept, in their order";
}

TEST(MeshFile, ascii_ply_with_foreign_properties_and_quads_is_read) {
  const std::string text =
      "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty double x\nproperty double y\nproperty double "
      "z\n"
      "property uchar seen\nelement note 1\nproperty list uchar int words\nelement face 1\n"
      "property uchar flag\nproperty list uchar int vertex_index\nend_header\n"
      "0 0 0 3\n1 0 0 4\n1 1 0 0\n0 1 0.5 7\n2 10 20\n9 4 0 1 2 3\n";
  const auto file = parse_mesh(text, MeshFormat::kPly);
  ASSERT_TRUE(file.has_value()) << file.error().detail;
  EXPECT_EQ(file->vertex_values.at("seen"), (std::vector<float>{3, 4, 0, 7}));
  ASSERT_EQ(file->mesh.triangles.size(), 2U);
  EXPECT_EQ(file->mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_EQ(file->mesh.vertices[3].z(), 0.5F);
}

TEST(MeshFile, stl_binary_welds_equal_positions) {
  const Mesh mesh = tetrahedron();
  const auto back = parse_mesh(stl_bytes(mesh), MeshFormat::kStl);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->mesh.vertices.size(), 4U);
  ASSERT_EQ(back->mesh.triangles.size(), 4U);
  for (std::size_t t = 0; t < 4; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(back->mesh.vertices[back->mesh.triangles[t][k]], mesh.vertices[mesh.triangles[t][k]]);
    }
  }
}

TEST(MeshFile, stl_ascii_is_read) {
  const auto file = parse_mesh(
      "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1e0 0 0\n   vertex 0 +1 0\n  endloop\n "
      "endfacet\nendsolid a\n",
      MeshFormat::kStl);
  ASSERT_TRUE(file.has_value()) << file.error().detail;
  EXPECT_EQ(file->mesh.vertices.size(), 3U);
  EXPECT_EQ(file->mesh.vertices[2].y(), 1.0F);
}

TEST(MeshFile, obj_keeps_floats_exactly) {
  Mesh mesh = tetrahedron();
  mesh.vertices[1].x() = 0.1F;
  const auto back = parse_mesh(obj_text(mesh), MeshFormat::kObj);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->mesh.vertices, mesh.vertices);
  EXPECT_EQ(back->mesh.normals, mesh.normals);
  EXPECT_EQ(back->mesh.triangles, mesh.triangles);
}

TEST(MeshFile, obj_negative_indices_count_from_the_end) {
  const auto file = parse_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3/1 -2/2 -1/3\n", MeshFormat::kObj);
  ASSERT_TRUE(file.has_value());
  EXPECT_EQ(file->mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
}

TEST(MeshFile, every_truncation_is_refused) {
  const std::string ply = ply_bytes(tetrahedron());
  const std::string stl = stl_bytes(tetrahedron());
  for (std::size_t n = 0; n < ply.size(); ++n) {
    EXPECT_FALSE(parse_mesh(std::string_view(ply).substr(0, n), MeshFormat::kPly).has_value()) << n;
  }
  for (std::size_t n = 0; n < stl.size(); ++n) {
    EXPECT_FALSE(parse_mesh(std::string_view(stl).substr(0, n), MeshFormat::kStl).has_value()) << n;
  }
}

TEST(MeshFile, flipped_bytes_never_crash) {
  for (const bool is_ply : {true, false}) {
    const std::string good = is_ply ? ply_bytes(tetrahedron()) : stl_bytes(tetrahedron());
    std::size_t refused = 0;
    for (std::size_t at = 0; at < good.size(); ++at) {
      for (const int flip : {0x01, 0x80, 0xff}) {
        std::string bad = good;
        bad[at] = static_cast<char>(static_cast<unsigned char>(bad[at]) ^ flip);
        refused += parse_mesh(bad, is_ply ? MeshFormat::kPly : MeshFormat::kStl).has_value() ? 0U : 1U;
      }
    }
    EXPECT_GT(refused, 10U);
  }
}

TEST(MeshFile, damage_is_named) {
  Mesh nan = tetrahedron();
  for (Vec3f& v : nan.vertices) v.y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(reason(parse_mesh(ply_bytes(nan), MeshFormat::kPly)), HasSubstr("4 vertices without a finite position"));
  EXPECT_THAT(reason(parse_mesh(stl_bytes(nan), MeshFormat::kStl)), HasSubstr("4 faces with such a corner"));
  Mesh beyond = tetrahedron();
  beyond.triangles[1][2] = 4;
  EXPECT_THAT(reason(parse_mesh(ply_bytes(beyond), MeshFormat::kPly)),
              HasSubstr("face 1 names a vertex that does not exist"));
  EXPECT_THAT(reason(parse_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", MeshFormat::kObj)), HasSubstr("line 4"));
  EXPECT_THAT(reason(parse_mesh("v 0 0 inf\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", MeshFormat::kObj)), HasSubstr("finite"));
  EXPECT_THAT(reason(parse_mesh(ply_bytes(Mesh{}), MeshFormat::kPly)), HasSubstr("empty"));
  EXPECT_THAT(reason(parse_mesh("", MeshFormat::kObj)), HasSubstr("empty"));
  EXPECT_THAT(reason(parse_mesh("solid x\nendsolid x\n", MeshFormat::kStl)), HasSubstr("empty"));
  EXPECT_THAT(reason(parse_mesh("solid x\nfacet\nvertex 0 0 0\nendfacet\nendsolid\n", MeshFormat::kStl)),
              HasSubstr("1 face without area"));
  EXPECT_THAT(reason(parse_mesh("ply\nformat binary_middle_endian 1.0\nend_header\n", MeshFormat::kPly)),
              HasSubstr("binary_middle_endian"));
  EXPECT_THAT(reason(parse_mesh("ply\nformat ascii 1.0\nelement vertex 99999999999999\nproperty float x\nproperty "
                                "float y\nproperty float z\nend_header\n0 0 0\n",
                                MeshFormat::kPly)),
              HasSubstr("truncated"));
}

class MeshFolder : public testing::Test {
 protected:
  MeshFolder() { std::filesystem::create_directories(folder_); }
  ~MeshFolder() override { std::filesystem::remove_all(folder_); }
  std::string folder_ = testing::TempDir() + "enamel_mesh_" + std::to_string(reinterpret_cast<std::uintptr_t>(this));
};

TEST_F(MeshFolder, formats_follow_the_extension) {
  for (const char* name : {"/a.ply", "/a.STL", "/a.obj"}) {
    ASSERT_TRUE(write_mesh(folder_ + name, tetrahedron()).has_value()) << name;
    const auto back = read_mesh(folder_ + name);
    ASSERT_TRUE(back.has_value()) << back.error().detail;
    EXPECT_EQ(back->mesh.triangles.size(), 4U);
  }
  EXPECT_EQ(write_mesh(folder_ + "/a.xyz", tetrahedron()).error().code, ErrorCode::kMeshInvalid);
  EXPECT_EQ(read_mesh(folder_ + "/none.ply").error().code, ErrorCode::kFileNotFound);
}

TEST_F(MeshFolder, a_failed_write_leaves_nothing_behind) {
  EXPECT_EQ(write_mesh(folder_ + "/missing/a.ply", tetrahedron()).error().code, ErrorCode::kFileWrite);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST(PosesCsv, round_trip_is_exact_to_a_nanometre_and_the_order_is_by_burst) {
  std::vector<PoseRow> rows(2);
  rows[0] = {7, 123456789012345, Pose::Identity()};
  rows[0].T_model_cam.linear() = Eigen::AngleAxisd(3.0, Vec3d(1, 2, -2).normalized()).toRotationMatrix();
  rows[0].T_model_cam.translation() = Vec3d(1.0 / 3.0, -47.5, 1e-6);
  rows[1] = {3, -5, Pose::Identity()};
  const auto back = parse_poses_csv(poses_csv_text(rows));
  ASSERT_TRUE(back.has_value()) << back.error().detail;
  ASSERT_EQ(back->size(), 2U);
  EXPECT_EQ((*back)[0].burst_id, 3U);
  EXPECT_EQ((*back)[1].t_ns, 123456789012345);
  EXPECT_LT(((*back)[1].T_model_cam.matrix() - rows[0].T_model_cam.matrix()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(PosesCsv, a_table_that_a_spreadsheet_saved_is_read) {
  const auto rows = parse_poses_csv(
      "\xef\xbb\xbf"
      "burst_id;t_ns;tx;ty;tz;qx;qy;qz;qw\r\n4;7;1,5;-2;3,25;0;0;0;1\r\n;;;;;;;;\r\n");
  ASSERT_TRUE(rows.has_value()) << rows.error().detail;
  ASSERT_EQ(rows->size(), 1U);
  EXPECT_EQ((*rows)[0].T_model_cam.translation(), Vec3d(1.5, -2, 3.25));
  EXPECT_FALSE(parse_poses_csv("burst_id;t_ns;tx;ty;tz;qx;qy;qz;qw\n4;7;1,5,2;-2;3,25;0;0;0;1\n").has_value());
  EXPECT_FALSE(parse_poses_csv("burst_id;t_ns;tx;ty;tz;qx;qy;qz;qw\n4;1,2E+14;1;-2;3;0;0;0;1\n").has_value());
}

TEST(PosesCsv, malformed_rows_are_named) {
  const std::string header = "burst_id,t_ns,tx,ty,tz,qx,qy,qz,qw\n";
  const auto detail = [&](const std::string& text) {
    const auto rows = parse_poses_csv(text);
    EXPECT_FALSE(rows.has_value());
    return rows ? std::string("accepted") : rows.error().detail;
  };
  EXPECT_THAT(detail(""), HasSubstr("line 1"));
  EXPECT_THAT(detail("a,b\n"), HasSubstr("header"));
  EXPECT_THAT(detail(header + "0,0,1,2,3,0,0,0\n"), HasSubstr("line 2: not nine fields"));
  EXPECT_THAT(detail(header + "0,0,1,nan,3,0,0,0,1\n"), HasSubstr("finite"));
  EXPECT_THAT(detail(header + "0,0,1,2,3,0,0,0,2\n"), HasSubstr("quaternion"));
  EXPECT_THAT(detail(header + "-1,0,1,2,3,0,0,0,1\n"), HasSubstr("whole number"));
  EXPECT_THAT(detail(header + "4,0,1,2,3,0,0,0,1\n4,0,1,2,3,0,0,0,1\n"), HasSubstr("burst 4 twice"));
}

}  // namespace
}  // namespace enamel::host
