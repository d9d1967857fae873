// The procedural jaw: a mesh without holes, fine enough, made by its seed alone; artefacts and mesh files.
#include <algorithm>
#include <filesystem>
#include <map>

#include "protocol/base/file.hpp"
#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/jaw/bite.hpp"
#include "tools/twin/optics/random.hpp"
#include "tools/twin/surface/mesh_file.hpp"

namespace enamel::twin {
namespace {

JawConfig coarse_jaw() {
  JawConfig c;
  c.max_edge_mm = 0.3;
  c.from_mm = 20;
  c.to_mm = 40;
  return c;
}

double longest_edge(const TriSurface& m) {
  double longest = 0;
  for (const auto& t : m.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      longest = std::max(longest, static_cast<double>((m.vertices[t[i]] - m.vertices[t[(i + 1) % 3]]).norm()));
    }
  }
  return longest;
}

TEST(TwinJaw, mesh_keeps_its_edge_limit_and_has_no_holes) {
  const JawConfig config = coarse_jaw();
  const Jaw jaw = make_jaw(config, 5);
  EXPECT_LE(longest_edge(jaw.mesh), config.max_edge_mm * 1.0001);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& t : jaw.mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++uses[std::minmax(t[i], t[(i + 1) % 3])];
  }
  const ArchCoordinates where{Arch(jaw.dentition.shape)};
  int open_inside = 0;
  for (const auto& [edge, count] : uses) {
    if (count != 1) continue;
    const auto& v = jaw.mesh.vertices[edge.first];
    const auto a = where.at(static_cast<double>(v.x()), static_cast<double>(v.y()));
    if (a.s > config.from_mm + 1 && a.s < config.to_mm - 1 && a.n > -8.5 && a.n < 7) ++open_inside;
  }
  EXPECT_EQ(open_inside, 0);
}

/// How deep the upper's deepest vertex is in the lower, mm; negative: so far apart.
double crossed_mm(const JawField& lower, const TriSurface& upper, const Eigen::Isometry3d& T_lower_upper) {
  double deepest = -1e9;
  for (const Vec3f& v : upper.vertices) deepest = std::max(deepest, -lower.value(T_lower_upper * v.cast<double>()));
  return deepest;
}

TEST(TwinBite, jaws_of_one_patient_meet_and_do_not_cross) {
  const JawConfig config = coarse_jaw();
  constexpr std::uint64_t kSeed = 6;
  const Bite bite = make_bite(config, kSeed);
  const Jaw lower = make_jaw(jaw_in_bite(config, JawSide::kLower), kSeed);
  const Jaw upper = make_jaw(jaw_in_bite(config, JawSide::kUpper), kSeed);
  const std::size_t lowers = lower.mesh.vertices.size(), uppers = upper.mesh.vertices.size();
  ASSERT_EQ(bite.mesh.vertices.size(), lowers + uppers);
  for (std::size_t i = 0; i < lowers; i += 997)
    EXPECT_LT((bite.T_bite_lower * lower.mesh.vertices[i].cast<double>() - bite.mesh.vertices[i].cast<double>()).norm(),
              1e-4);
  for (std::size_t i = 0; i < uppers; i += 997)
    EXPECT_LT(
        (bite.T_bite_upper * upper.mesh.vertices[i].cast<double>() - bite.mesh.vertices[lowers + i].cast<double>())
            .norm(),
        1e-4);
  const JawField field(lower.dentition, JawSide::kLower, kSeed);
  Eigen::Isometry3d T_lower_upper = bite.T_bite_lower.inverse() * bite.T_bite_upper;
  constexpr double kCell_mm = 0.25;  // of the maps that say where they meet: slopes are taken for steps
  EXPECT_LT(crossed_mm(field, upper.mesh, T_lower_upper), kCell_mm);
  EXPECT_GT(crossed_mm(field, upper.mesh, T_lower_upper), -2 * kCell_mm);
  T_lower_upper.translation().z() -= 6 * kCell_mm;  // the control: bitten through
  EXPECT_GT(crossed_mm(field, upper.mesh, T_lower_upper), kCell_mm);
}

TEST(TwinJaw, surface_is_wound_outwards_and_carries_enamel_and_gum) {
  const Jaw jaw = make_jaw(coarse_jaw(), 5);
  double up = 0;
  for (const auto& n : jaw.mesh.normals) up += static_cast<double>(n.z());
  EXPECT_GT(up / static_cast<double>(jaw.mesh.normals.size()), 0.2);
  const auto enamel = std::count_if(jaw.mesh.albedo.begin(), jaw.mesh.albedo.end(), [](float a) { return a > 0.79F; });
  const auto gum = std::count_if(jaw.mesh.albedo.begin(), jaw.mesh.albedo.end(), [](float a) { return a < 0.605F; });
  const auto n = static_cast<double>(jaw.mesh.albedo.size());
  EXPECT_GT(static_cast<double>(enamel) / n, 0.2);
  EXPECT_GT(static_cast<double>(gum) / n, 0.2);
}

/// Seen by the probe at its own pixel pitch, enamel and gum are closed: no ray slips through a hole or a folded facet.
TEST(TwinJaw, probe_sees_no_pinholes) {
  SceneConfig scene = testing::plane_scene();
  scene.object = ObjectKind::kJaw;
  scene.path = PathKind::kArch;
  scene.arch_path.passes = {{35, 36, 0, 5}};
  scene.jaw.from_mm = 28;
  scene.jaw.to_mm = 43;
  scene.timing.bursts = 1;
  scene.effects.motion = false;
  scene.render.grid = 1;
  const auto source = testing::source_of(scene, testing::probe_rig());
  ASSERT_TRUE(source->next());
  const auto& depth = source->truth().maps.depth;
  int holes = 0, hits = 0;
  constexpr int kWidth = 640, kReach = 4;
  for (int y = kReach; y < 480 - kReach; ++y) {
    for (int x = kReach; x < kWidth - kReach; ++x) {
      const auto hit = [&](int dx, int dy) {
        return !std::isnan(depth[static_cast<std::size_t>((y + dy) * kWidth + x + dx)]);
      };
      hits += hit(0, 0) ? 1 : 0;
      if (!hit(0, 0) && hit(kReach, 0) && hit(-kReach, 0) && hit(0, kReach) && hit(0, -kReach)) ++holes;
    }
  }
  EXPECT_GT(hits, 200000);
  EXPECT_LE(holes, 3);
}

TEST(TwinJaw, palate_is_meshed_to_its_middle_when_asked_for) {
  JawConfig config;
  config.side = JawSide::kUpper;
  config.both_sides = true;
  config.max_edge_mm = 1.0;
  const auto in_the_middle = [&] {
    const TriSurface mesh = make_jaw(config, 5).mesh;
    return std::count_if(mesh.vertices.begin(), mesh.vertices.end(),
                         [](const Vec3f& v) { return std::abs(v.x()) < 3 && v.y() < -20 && v.y() > -30; });
  };
  EXPECT_EQ(in_the_middle(), 0);
  config.palate = true;
  EXPECT_GT(in_the_middle(), 50);
}

TEST(TwinJaw, seed_makes_the_patient) {
  const Jaw a = make_jaw(coarse_jaw(), 5), again = make_jaw(coarse_jaw(), 5), b = make_jaw(coarse_jaw(), 6);
  ASSERT_EQ(a.mesh.vertices.size(), again.mesh.vertices.size());
  EXPECT_TRUE(std::equal(a.mesh.vertices.begin(), a.mesh.vertices.end(), again.mesh.vertices.begin()));
  EXPECT_EQ(a.mesh.triangles, again.mesh.triangles);
  EXPECT_NE(a.mesh.vertices.size(), b.mesh.vertices.size());
  ASSERT_EQ(a.dentition.teeth.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_NE(a.dentition.teeth[i].form.mesiodistal, b.dentition.teeth[i].form.mesiodistal);
  }
  EXPECT_NE(a.dentition.shape.depth_mm, b.dentition.shape.depth_mm);
}

TEST(TwinJaw, teeth_stand_in_order_with_narrow_gaps) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto d = make_dentition(JawSide::kLower, 7, true, seed);
    ASSERT_EQ(d.teeth.size(), 14U);
    for (std::size_t i = 1; i < d.teeth.size(); ++i) {
      const auto &l = d.teeth[i - 1], &r = d.teeth[i];
      const double gap = r.s - l.s - 0.5 * (r.form.mesiodistal + l.form.mesiodistal);
      EXPECT_GE(gap, 0.05);
      EXPECT_LE(gap, 0.3);
    }
  }
}

/// What lets the polygoniser skip a cube: from a point of the surface the field rises by no more than the bound times
/// the way.
TEST(TwinJaw, field_rises_no_faster_than_its_bound) {
  const JawField field(make_dentition(JawSide::kLower, 7, false, 3), JawSide::kLower, 3);
  const CounterRandom random(1, 1);
  int tried = 0;
  double steepest = 0;
  for (std::uint64_t i = 0; i < 150000; ++i) {
    const Eigen::Vector3d p(random.uniform(8 * i, -5, 34), random.uniform(8 * i + 1, -46, 7),
                            random.uniform(8 * i + 2, -9, 11));
    const double v = field.value(p);
    if (std::abs(v) > 0.02) continue;
    const NormalPair a = random.normals(4 * i + 1), b = random.normals(4 * i + 2);
    const Eigen::Vector3d way = 0.12 * Eigen::Vector3d(a.a, a.b, b.a).normalized();
    steepest = std::max(steepest, std::abs(field.value(p + way) - v) / way.norm());
    ++tried;
  }
  EXPECT_GT(tried, 500);
  EXPECT_LE(steepest, JawField::kLipschitz);
  EXPECT_GT(steepest, 0.5 * JawField::kLipschitz);  // and the bound is not idle
}

TEST(TwinArtefacts, stairs_have_the_stated_rises) {
  StepsConfig config;
  const auto steps = make_steps(config);
  std::vector<float> heights;
  for (const auto& t : steps.mesh.triangles) {
    const auto &a = steps.mesh.vertices[t[0]], &b = steps.mesh.vertices[t[1]], &c = steps.mesh.vertices[t[2]];
    if (a.z() == b.z() && b.z() == c.z() && a.y() > 0.1F) heights.push_back(a.z());
  }
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  std::vector<float> expected{0};
  for (const double r : config.rises_mm) expected.push_back(expected.back() + static_cast<float>(r));
  std::sort(expected.begin(), expected.end());
  ASSERT_EQ(heights.size(), expected.size());
  for (std::size_t i = 1; i < heights.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(heights[i] - heights[i - 1]), static_cast<double>(expected[i] - expected[i - 1]),
                1e-5);
  }
}

TEST(TwinArtefacts, balls_tessellate_on_their_sphere) {
  const Ball ball{Vec3d(1, 2, 3), 2.5, 0.8F};
  const auto mesh = tessellate(ball, 0.2);
  EXPECT_LE(longest_edge(mesh), 0.2 * 1.5);
  for (const auto& v : mesh.vertices) EXPECT_NEAR((v.cast<double>() - ball.centre).norm(), 2.5, 1e-6);
}

TriSurface triangle() {
  TriSurface m;
  m.vertices = {Vec3f(0, 0, 0), Vec3f(2, 0, 0), Vec3f(0, 1.5F, 0.25F)};
  m.triangles = {{0, 1, 2}};
  return m;
}

class TwinMeshFile : public ::testing::Test {
 protected:
  TwinMeshFile() { std::filesystem::create_directories(folder_); }
  ~TwinMeshFile() override { std::filesystem::remove_all(folder_); }
  Result<TriSurface> loaded(const std::string& name, const std::string& bytes) {
    EXPECT_TRUE(write_file(folder_ + name, bytes));
    return load_mesh(folder_ + name, 0.8F);
  }
  std::string folder_ =
      ::testing::TempDir() + "twin_mesh_" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + "/";
};

TEST_F(TwinMeshFile, ply_round_trip_keeps_vertices_and_faces) {
  const TriSurface m = triangle();
  const std::vector<std::uint8_t> seen{1, 2, 255};
  for (const bool with : {false, true}) {
    const auto back =
        loaded("a.ply", write_ply(m, with ? std::span<const std::uint8_t>(seen) : std::span<const std::uint8_t>()));
    ASSERT_TRUE(back) << back.error().message();
    EXPECT_TRUE(std::equal(m.vertices.begin(), m.vertices.end(), back->vertices.begin(), back->vertices.end()));
    EXPECT_EQ(back->triangles, m.triangles);
    EXPECT_EQ(back->albedo, std::vector<float>(3, 0.8F));
    EXPECT_EQ(back->normals.size(), 3U);
  }
}

TEST_F(TwinMeshFile, other_programs_files_are_read) {
  const auto obj = loaded("a.OBJ", "# square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1 2/2 \\\n3/3 -1\n");
  ASSERT_TRUE(obj) << obj.error().message();
  EXPECT_EQ(obj->triangles.size(), 2U);
  const auto stl = loaded("a.stl",
                          "\nSOLID a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                          "endloop\nendfacet\nendsolid\n");
  ASSERT_TRUE(stl) << stl.error().message();
  EXPECT_EQ(stl->vertices.size(), 3U);
}

TEST_F(TwinMeshFile, damaged_files_are_errors_not_crashes) {
  const std::string good = write_ply(triangle(), {});
  for (std::size_t length = 0; length < good.size(); length += 7) EXPECT_FALSE(loaded("a.ply", good.substr(0, length)));
  EXPECT_FALSE(loaded("a.obj", "v 0 0 0\nv 1 0 0\nv nan 0 0\nf 1 2 3\n"));
  EXPECT_FALSE(loaded("a.obj", "v 0 0 9000\nv 1 0 9000\nv 0 1 9000\nf 1 2 3\n"));
  EXPECT_FALSE(loaded("a.stl", std::string(84, 'x')));
  EXPECT_FALSE(loaded("a.xyz", good));
  EXPECT_FALSE(load_mesh("/nonexistent.ply", 0.8F));
}

}  // namespace
}  // namespace enamel::twin
