// Bases under drawn surfaces: each closed one is watertight by a check that open, turned and crowded ones fail.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "host/mesh_base/close_base.hpp"
#include "host/mesh_base/foot_polygon.hpp"
#include "host/mesh_files/mesh_file.hpp"

namespace enamel::host {
namespace {

constexpr double kStep_mm = 0.5;

/// A hill whose border runs in and out by the seed, with holes in it; `lean` shears it until its shadow folds over.
Mesh drawn_surface(unsigned seed, int holes, double lean) {
  std::mt19937 draw(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  std::array<double, 6> in_out{}, phase{};
  for (std::size_t k = 0; k < in_out.size(); ++k) {
    in_out[k] = any(draw) * 2.2 / (1.0 + static_cast<double>(k) / 2);
    phase[k] = any(draw) * M_PI;
  }
  std::vector<Vec3d> hole(static_cast<std::size_t>(holes));
  for (Vec3d& h : hole) h = {4 * any(draw), 4 * any(draw), 0.6 + 0.5 * std::fabs(any(draw))};
  const auto inside = [&](double x, double y) {
    double radius = 9;
    for (std::size_t k = 0; k < in_out.size(); ++k)
      radius += in_out[k] * std::cos(static_cast<double>(k + 1) * std::atan2(y, x) + phase[k]);
    bool in = std::hypot(x, y) < radius;
    for (const Vec3d& h : hole) in = in && std::hypot(x - h.x(), y - h.y()) > h.z();
    return in;
  };
  constexpr int kCells = 64;
  Mesh mesh;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const double x = kStep_mm * (i - kCells / 2), y = kStep_mm * (j - kCells / 2);
      const double z = 3 * std::sin(0.5 * x + phase[0]) + 2 * std::cos(0.7 * y + phase[1]);
      mesh.vertices.emplace_back(Vec3d(x + lean * z, y - lean * z, z).cast<float>());
    }
  }
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      if (!inside(kStep_mm * (i + 0.5 - kCells / 2), kStep_mm * (j + 0.5 - kCells / 2))) continue;
      const auto v = static_cast<std::uint32_t>(j * (kCells + 1) + i), w = v + kCells + 1;
      mesh.triangles.push_back({v, v + 1, w + 1});
      mesh.triangles.push_back({v, w + 1, w});
    }
  }
  return mesh;
}

Mesh moved(Mesh mesh, const Pose& T) {
  for (Vec3f& v : mesh.vertices) v = (T * v.cast<double>()).cast<float>();
  return mesh;
}

TEST(MeshBase, drawn_surfaces_become_watertight) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const auto closed = close_base(drawn_surface(seed, static_cast<int>(seed % 5), 0), {.up = Vec3d(0, 0, 1)});
    ASSERT_TRUE(closed) << seed << ' ' << closed.error().detail;
    EXPECT_TRUE(closed->check.holds()) << seed << ' ' << leaks_text(closed->check);
    EXPECT_EQ(closed->folded, 0U) << seed;
    EXPECT_EQ(closed->crossings, 0U) << seed << ": a height field's border casts a shadow that does not cross itself";
    // Of a height field the bottom is the shadow of everything above it, holes included.
    double shadow = 0;
    for (std::size_t f = 0; f < closed->mesh.triangles.size(); ++f) {
      const auto& t = closed->mesh.triangles[f];
      const auto at = [&](std::size_t k) -> Vec3d { return closed->mesh.vertices[t[k]].cast<double>(); };
      const double area = (at(1) - at(0)).cross(at(2) - at(0)).z() / 2;
      shadow += area > 0 ? area : 0;
    }
    EXPECT_NEAR(closed->bottom_mm2, shadow, 1e-3 * shadow) << seed;
  }
}

TEST(MeshBase, borders_whose_shadow_crosses_itself_become_watertight) {
  std::uint64_t crossings = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const auto closed = close_base(drawn_surface(seed, 2, 0.9), {.up = Vec3d(0, 0, 1)});
    ASSERT_TRUE(closed) << seed << ' ' << closed.error().detail;
    EXPECT_EQ(closed->folded, 0U) << seed;
    crossings += closed->crossings;
  }
  EXPECT_GT(crossings, 20U) << "the surfaces were to lean until their shadows cross";
}

TEST(MeshBase, measured_part_is_kept_to_the_bit_and_comes_first) {
  const Mesh surface = drawn_surface(7, 3, 0.2);
  const auto closed = close_base(surface, {});
  ASSERT_TRUE(closed);
  std::size_t f = 0;
  for (const auto& t : surface.triangles) {  // no face of this one is left out
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(surface.vertices[t[k]], closed->mesh.vertices[closed->mesh.triangles[f][k]]);
    ++f;
  }
  EXPECT_EQ(closed->measured_faces, surface.triangles.size());
  EXPECT_GE(closed->holes, 2U);
  EXPECT_GT(closed->synthetic_faces(), 100U);
}

TEST(MeshBase, base_goes_along_with_the_surface) {
  const Mesh surface = drawn_surface(4, 1, 0);
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(2.2, Vec3d(1, 2, -0.5).normalized()).toRotationMatrix();
  T.translation() = Vec3d(30, -12, 80);
  const auto here = close_base(surface, {.up = Vec3d(0, 0, 1)});
  const auto there = close_base(moved(surface, T), {.up = T.linear() * Vec3d(0, 0, 1)});
  ASSERT_TRUE(here && there);
  EXPECT_NEAR(there->check.volume_mm3, here->check.volume_mm3, 1e-4 * here->check.volume_mm3);
}

TEST(MeshBase, two_pieces_get_bases_and_dust_none) {
  Mesh both = drawn_surface(3, 0, 0);
  const auto add = [&](const Mesh& more, float by) {
    const auto first = static_cast<std::uint32_t>(both.vertices.size());
    for (const Vec3f& v : more.vertices) both.vertices.push_back(v + Vec3f(by, 0, 0));
    for (const auto& t : more.triangles) both.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  };
  add(drawn_surface(5, 0, 0), 60);
  const std::size_t faces = both.triangles.size();
  Mesh dust;
  dust.vertices = {{0, 0, 20}, {1, 0, 20}, {0, 1, 20}};
  dust.triangles = {{0, 1, 2}};
  add(dust, 0);
  const auto closed = close_base(both, {.up = Vec3d(0, 0, 1)});
  ASSERT_TRUE(closed) << closed.error().detail;
  EXPECT_EQ(closed->pieces, 2U);
  EXPECT_EQ(closed->left_out_pieces, 1U);
  EXPECT_EQ(closed->measured_faces, faces);
}

TEST(MeshBase, crowded_edges_and_pinched_vertices_are_left_out_and_told) {
  Mesh dirty = drawn_surface(6, 0, 0);
  const std::size_t clean = dirty.triangles.size();
  const auto t = dirty.triangles[clean / 2];
  dirty.vertices.emplace_back(0.1F, 0.2F, 30.0F);
  dirty.triangles.push_back({t[0], t[1], static_cast<std::uint32_t>(dirty.vertices.size() - 1)});  // a fin
  dirty.triangles.push_back(t);                                                                    // given twice
  const auto closed = close_base(dirty, {.up = Vec3d(0, 0, 1)});
  ASSERT_TRUE(closed) << closed.error().detail;
  EXPECT_EQ(closed->left_out_faces, 2U);
  EXPECT_EQ(closed->measured_faces, clean);
}

/// The control: a check that let these pass would be none.
TEST(MeshBase, check_refuses_what_leaks) {
  const auto closed = close_base(drawn_surface(2, 2, 0), {.up = Vec3d(0, 0, 1)});
  ASSERT_TRUE(closed);
  std::mt19937 draw(11);
  for (int n = 0; n < 20; ++n) {
    const auto at = draw() % closed->mesh.triangles.size();
    Mesh open = closed->mesh;
    open.triangles.erase(open.triangles.begin() + static_cast<std::ptrdiff_t>(at));
    EXPECT_EQ(check_watertight(open).open_edges, 3U);
    EXPECT_FALSE(check_watertight(open).holds());
    Mesh turned = closed->mesh;
    std::swap(turned.triangles[at][0], turned.triangles[at][1]);
    EXPECT_EQ(check_watertight(turned).turned_edges, 3U);
    EXPECT_FALSE(check_watertight(turned).holds());
    Mesh doubled = closed->mesh;
    doubled.triangles.push_back(doubled.triangles[at]);
    EXPECT_EQ(check_watertight(doubled).crowded_edges, 3U);
    EXPECT_FALSE(check_watertight(doubled).holds());
  }
  Mesh inside_out = closed->mesh;
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  EXPECT_FALSE(check_watertight(inside_out).holds());
  EXPECT_FALSE(check_watertight(drawn_surface(2, 2, 0)).holds());
}

TEST(MeshBase, what_cannot_have_a_base_is_refused) {
  const auto closed = close_base(drawn_surface(2, 0, 0), {.up = Vec3d(0, 0, 1)});
  ASSERT_TRUE(closed);
  EXPECT_FALSE(close_base(closed->mesh, {}));                                 // closed already
  EXPECT_FALSE(close_base({}, {}));                                           // nothing
  EXPECT_FALSE(close_base(drawn_surface(2, 0, 0), {.up = Vec3d(0, 0, -1)}));  // looks down
  EXPECT_FALSE(close_base(drawn_surface(2, 0, 0), {.up = Vec3d(0, 0, 0)}));
  EXPECT_FALSE(close_base(drawn_surface(2, 0, 0), {.up = Vec3d(std::nan(""), 0, 1)}));
}

TEST(MeshBase, files_tell_what_was_made_up_and_measurements_leave_it_out) {
  const Mesh surface = drawn_surface(9, 2, 0.3);
  const auto closed = close_base(surface, {.up = Vec3d(0, 0, 1)});
  ASSERT_TRUE(closed);
  for (const auto& [bytes, format] :
       {std::pair(closed_ply(*closed), MeshFormat::kPly), std::pair(closed_obj(*closed), MeshFormat::kObj)}) {
    const auto read = parse_mesh(bytes, format);
    ASSERT_TRUE(read);
    EXPECT_TRUE(check_watertight(read->mesh).holds()) << leaks_text(check_watertight(read->mesh));
    const auto measured = leave_out_synthetic(*read);
    ASSERT_TRUE(measured);
    EXPECT_EQ(measured->mesh.triangles.size(), surface.triangles.size());
    EXPECT_EQ(measured->mesh.vertices.size(), closed->measured_vertices);
    EXPECT_EQ(measured->left_out.synthetic_faces, closed->synthetic_faces());
    EXPECT_EQ(measured->left_out.unused_vertices, 0U);
  }
  const auto stl = parse_mesh(closed_stl(*closed), MeshFormat::kStl);
  ASSERT_TRUE(stl);
  EXPECT_TRUE(check_watertight(stl->mesh).holds()) << leaks_text(check_watertight(stl->mesh));
  EXPECT_EQ(nlohmann::json::parse(base_json(*closed))["synthetic_faces"], closed->synthetic_faces());
  // The control: a file without tags is all measured, and one of nothing but base is refused.
  EXPECT_EQ(leave_out_synthetic(*stl)->left_out.synthetic_faces, 0U);
  MeshFile base = *parse_mesh(closed_ply(*closed), MeshFormat::kPly);
  base.synthetic.assign(base.synthetic.size(), 1);
  EXPECT_FALSE(leave_out_synthetic(base));
}

TEST(MeshBase, shadows_are_cut_where_they_cross_and_ears_fill_what_is_left) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937 draw(seed);
    std::uniform_real_distribution<double> any(-1, 1);
    const double loops = 1.5 * any(draw) + 1.6;
    std::vector<Vec2d> shadow;
    for (int k = 0; k < 150; ++k) {  // a circle with small loops in its line
      const double a = 2 * M_PI * k / 150, b = 13 * a + any(draw) * 0.05;
      shadow.emplace_back(10 * std::cos(a) + loops * std::cos(b), 10 * std::sin(a) + loops * std::sin(b));
    }
    const FootPolygon foot = uncrossed(shadow);
    ASSERT_GE(foot.points.size(), 3U) << seed;
    ASSERT_EQ(foot.of.size(), shadow.size());
    EXPECT_EQ(uncrossed(foot.points).crossings, 0U) << seed;
    const Ears ears = cut_ears(foot.points);
    ASSERT_EQ(ears.triangles.size(), foot.points.size() - 2);
    double area = 0;
    for (const auto& [a, b, c] : ears.triangles) area += signed_area({foot.points[a], foot.points[b], foot.points[c]});
    EXPECT_NEAR(area, signed_area(foot.points), 1e-9 * area) << seed;
    EXPECT_EQ(ears.folded, 0U) << seed;
  }
}

}  // namespace
}  // namespace enamel::host
