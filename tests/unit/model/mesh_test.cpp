// Meshing: closed and manifold by construction, one burst's outliers stay out, incremental equals full.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "pipeline/model/fuse/tsdf_model.hpp"
#include "pipeline/model/mesh/components.hpp"
#include "pipeline/model/mesh/incremental_mesher.hpp"
#include "tests/unit/model/mesh_checks.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::pipeline {
namespace {

using synthetic::looking_at;
using synthetic::render;

/// Fuses views from all around, each pose twice.
void scan_all_around(TsdfModel& model, const calib::Rig& rig, const synthetic::Surface& surface, bool noisy) {
  std::uint64_t burst = 0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) {
          continue;
        }
        for (int again = 0; again < 2; ++again) {
          const Pose pose = looking_at(Vec3d::Zero(), Vec3d(x, y, z), 48.0, 0.2 * again);
          model.integrate(BurstId{burst}, render(rig, surface, pose, {0.0085, noisy, burst + 1}), pose);
          ++burst;
        }
      }
    }
  }
}

TEST(Mesh, a_sphere_scanned_all_around_is_one_closed_manifold_of_the_right_volume) {
  const calib::Rig rig = synthetic::small_rig();
  TsdfModel model(rig);
  scan_all_around(model, rig, synthetic::sphere(Vec3d::Zero(), 2.0), true);
  IncrementalMesher mesher;
  mesher.update(model, model.take_changed());
  ExtractStats stats;
  const Mesh mesh = mesher.extract(&stats);
  EXPECT_EQ(open_or_crowded_edges(mesh), 0U);
  const auto edges = static_cast<std::int64_t>(edges_of(mesh).size());
  EXPECT_EQ(static_cast<std::int64_t>(mesh.vertices.size()) - edges + static_cast<std::int64_t>(mesh.triangles.size()),
            2);
  EXPECT_NEAR(volume(mesh), 4.0 / 3.0 * M_PI * 8.0, 4.0 * M_PI * 4.0 * 0.003);  // 3 um over the whole surface
  double worst = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    worst = std::max(worst, std::abs(mesh.vertices[i].cast<double>().norm() - 2.0));
    EXPECT_GT(mesh.normals[i].dot(mesh.vertices[i].normalized()), 0.97F);
    EXPECT_GT(mesh.quality[i], 0.0F);
    EXPECT_LE(mesh.quality[i], 1.0F);
  }
  EXPECT_LT(worst, 0.015);
}

TEST(Mesh, incremental_equals_full_bit_for_bit) {
  const calib::Rig rig = synthetic::small_rig();
  const auto surface = synthetic::sphere(Vec3d::Zero(), 3.0);
  TsdfModel model(rig);
  IncrementalMesher incremental;
  for (std::uint64_t k = 0; k < 8; ++k) {
    const Pose pose = looking_at({0.3 * static_cast<double>(k), 0, 0}, {0.1, 0.02 * static_cast<double>(k), 1}, 48);
    model.integrate(BurstId{k}, render(rig, surface, pose, {0.0085, true, k}), pose);
    incremental.update(model, model.take_changed(0.002), 150);  // leaves small moves and part of the queue for later
  }
  EXPECT_EQ(incremental.update(model, model.take_changed(0.0)).blocks_waiting, 0U);
  std::vector<BlockIndex> all;
  for (std::size_t i = 0; i < model.grid().size(); ++i) {
    all.push_back(model.grid().block(static_cast<std::int32_t>(i)).index);
  }
  IncrementalMesher full;
  full.update(model, all);
  const Mesh a = incremental.extract();
  const Mesh b = full.extract();
  ASSERT_GT(a.triangles.size(), 1000U);
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  ASSERT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(0, std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3f)));
  EXPECT_EQ(0, std::memcmp(a.normals.data(), b.normals.data(), a.normals.size() * sizeof(Vec3f)));
  EXPECT_EQ(crowded_edges(a), 0U);
}

TEST(Mesh, unchanged_blocks_are_shared_between_snapshots) {
  const calib::Rig rig = synthetic::small_rig();
  const auto surface = synthetic::plane({0, 0, -1}, 0.0);
  TsdfModel model(rig);
  IncrementalMesher mesher;
  std::vector<ModelSnapshot> snapshots;
  for (std::uint64_t k = 0; k < 4; ++k) {
    const Pose pose = looking_at({k < 2 ? 0.0 : 14.0, 0, 0}, {0, 0, 1}, 48);
    model.integrate(BurstId{k}, render(rig, surface, pose), pose);
    mesher.update(model, model.take_changed());
    snapshots.push_back(mesher.snapshot());
  }
  EXPECT_TRUE(snapshots[0].blocks.empty());  // one burst is not enough
  ASSERT_FALSE(snapshots[1].blocks.empty());
  EXPECT_EQ(snapshots[3].after_burst, 3U);
  std::size_t shared = 0;
  for (const auto& block : snapshots[1].blocks) {
    for (const auto& later : snapshots[3].blocks) {
      shared += block == later ? 1U : 0U;
    }
  }
  EXPECT_GT(shared, snapshots[1].blocks.size() / 2);
  EXPECT_TRUE(std::is_sorted(snapshots[3].blocks.begin(), snapshots[3].blocks.end(),
                             [](const auto& a, const auto& b) { return a->block < b->block; }));
}

/// Vertices of the mesh near an outlier that only the first of three bursts showed.
std::size_t vertices_near_outlier(int min_bursts, int min_observations) {
  const calib::Rig rig = synthetic::small_rig();
  FuseConfig config;
  config.min_bursts = min_bursts;
  config.min_observations = min_observations;
  config.carve_margin_mm = 1e9;  // the rule alone, without carving
  TsdfModel model(rig, config);
  const auto ground = synthetic::plane({0, 0, -1}, 0.0);
  const Vec3d outlier(0, 0, -3);
  for (std::uint64_t k = 0; k < 3; ++k) {
    const Pose pose = looking_at({0.2 * static_cast<double>(k), 0, 0}, {0, 0, 1}, 48);
    const auto seen = k == 0 ? synthetic::nearest(ground, synthetic::sphere(outlier, 0.8)) : ground;
    model.integrate(BurstId{k}, render(rig, seen, pose), pose);
  }
  MeshConfig mesh_config;
  mesh_config.min_component_triangles = 1;
  mesh_config.passing_bursts = 0;
  IncrementalMesher mesher(mesh_config);
  mesher.update(model, model.take_changed());
  const Mesh mesh = mesher.extract();
  EXPECT_GT(mesh.vertices.size(), 5000U);
  std::size_t near = 0;
  for (const Vec3f& v : mesh.vertices) {
    near += (v.cast<double>() - outlier).norm() < 1.5 ? 1U : 0U;
  }
  return near;
}

TEST(Mesh, outliers_of_one_burst_never_reach_the_mesh) { EXPECT_EQ(vertices_near_outlier(2, 3), 0U); }

TEST(Mesh, without_the_burst_rule_the_same_outliers_would_reach_it) { EXPECT_GT(vertices_near_outlier(1, 1), 100U); }

TEST(Mesh, a_rounded_edge_of_a_tenth_of_a_millimetre_stays_sharper_than_fifteen_hundredths) {
  const calib::Rig rig = synthetic::rig();
  const auto surface = synthetic::wedge(0.1);
  TsdfModel model(rig);
  synthetic::Random random(5);
  for (std::uint64_t k = 0; k < 12; ++k) {
    const Vec3d shift = random.vector();
    const Vec3d tilt = random.vector();
    const Pose pose = looking_at({shift.x(), shift.y(), 0}, {tilt.x(), 0.3 * tilt.y(), 1}, 48, 0.3 * tilt.z());
    model.integrate(BurstId{k}, render(rig, surface, pose, {0.0085, true, k + 1}), pose);
  }
  IncrementalMesher mesher;
  mesher.update(model, model.take_changed());
  const Mesh mesh = mesher.extract();
  // A 45-degree edge of radius r lies (sqrt 2 - 1) r below the corner of its faces: the height of the ridge tells r.
  const double corner = -(std::sqrt(2.0) - 1.0) * 0.1;
  double sum = 0;
  int count = 0;
  for (const Vec3f& v : mesh.vertices) {
    if (std::abs(v.x()) < 0.03F && std::abs(v.y()) < 4.0F) {
      sum += static_cast<double>(v.z());
      ++count;
    }
  }
  ASSERT_GT(count, 20);
  const double radius = (sum / count - corner) / (std::sqrt(2.0) - 1.0);
  std::printf("edge radius 0.100 mm becomes %.3f mm\n", radius);
  EXPECT_GT(radius, 0.08);
  EXPECT_LT(radius, 0.15);
}

TEST(Components, small_pieces_are_removed_and_counted) {
  Mesh mesh;
  const auto strip = [&](int triangles, float z) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int i = 0; i < triangles + 2; ++i) {
      mesh.vertices.emplace_back(static_cast<float>(i), static_cast<float>(i % 2), z);
    }
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(triangles); ++i) {
      mesh.triangles.push_back({first + i, first + i + 1, first + i + 2});
    }
  };
  strip(3, 0);
  strip(10, 1);
  strip(4, 2);
  const ComponentStats stats = remove_small_components(mesh, {.min_triangles = 5});
  EXPECT_EQ(stats.components, 3U);
  EXPECT_EQ(stats.removed, 2U);
  EXPECT_EQ(stats.triangles_removed, 7U);
  EXPECT_EQ(mesh.triangles.size(), 10U);
  EXPECT_EQ(mesh.vertices.size(), 12U);
  EXPECT_EQ(mesh.vertices[0].z(), 1.0F);
}

Mesh two_strips() {
  Mesh mesh;
  for (const float y : {0.0F, 10.0F}) {
    const int triangles = y == 0.0F ? 20 : 10;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int i = 0; i < triangles + 2; ++i) mesh.vertices.emplace_back(0.1F * static_cast<float>(i), y, 0.0F);
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(triangles); ++i)
      mesh.triangles.push_back({first + i, first + i + 1, first + i + 2});
  }
  return mesh;
}

TEST(Components, a_floating_piece_seen_for_a_moment_goes) {
  const ComponentRules rules{.min_triangles = 1, .passing_triangles = 15, .passing_bursts = 24};
  const auto left = [&](std::uint64_t last, bool with_time = true) {
    Mesh mesh = two_strips();
    std::vector<SeenSpan> seen(mesh.vertices.size(), SeenSpan{100, 300});
    for (std::size_t v = 22; v < seen.size(); ++v) seen[v] = {120, last};
    (void)remove_small_components(mesh, rules,
                                  with_time ? std::span<const SeenSpan>(seen) : std::span<const SeenSpan>());
    return mesh.triangles.size();
  };
  EXPECT_EQ(left(130), 20U);
  EXPECT_EQ(left(200), 30U);         // control: seen again later
  EXPECT_EQ(left(130, false), 30U);  // control: nothing known of time
}

TEST(Components, the_largest_piece_stays_however_short_it_was_seen) {
  Mesh mesh = two_strips();
  const std::vector<SeenSpan> seen(mesh.vertices.size(), SeenSpan{0, 5});
  (void)remove_small_components(mesh, {.min_triangles = 1, .passing_triangles = 8000, .passing_bursts = 24}, seen);
  EXPECT_EQ(mesh.triangles.size(), 20U);
}

TEST(Mesh, an_empty_model_gives_an_empty_mesh) {
  const TsdfModel model(synthetic::small_rig());
  IncrementalMesher mesher;
  mesher.update(model, {});
  EXPECT_TRUE(mesher.extract().triangles.empty());
  EXPECT_TRUE(mesher.snapshot().blocks.empty());
}

}  // namespace
}  // namespace enamel::pipeline
