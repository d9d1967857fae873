// The map after a scan, on an analytic surface: drift that tracking left goes, the same bits on any number of threads.
#include "pipeline/register/map/refine_map.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "pipeline/flow/parallel.hpp"
#include "pipeline/register/map/keyframe_choice.hpp"
#include "tests/unit/register/burst_times.hpp"
#include "tests/unit/register/drifting_scan.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr int kBursts = DriftingScan::kBursts;

Pose tracked(int n) { return DriftingScan::tracked(n); }
double error_mm(const Pose& T_model_cam, int n) { return DriftingScan::error_mm(T_model_cam, n); }

class RefineMap : public ::testing::Test {
 protected:
  [[nodiscard]] RefinedMap refine(std::size_t threads = 2) {
    scan_.input.for_each = [threads](std::size_t count, const std::function<void(std::size_t)>& work) {
      flow::for_each_index(count, threads, work);
    };
    return refine_map(scan_.input, scan_.rig, {}, scan_.config);
  }
  DriftingScan scan_;
};

TEST_F(RefineMap, takes_out_what_tracking_let_drift) {
  const RefinedMap map = refine();
  EXPECT_EQ(map.keyframes, static_cast<std::size_t>(kBursts));
  EXPECT_GT(map.loops, 10U);
  EXPECT_EQ(map.switched_off, 0);
  double before = 0, after = 0;
  for (int n = 0; n < kBursts; ++n) {
    before = std::max(before, error_mm(tracked(n), n));
    after = std::max(after, error_mm(map.poses[static_cast<std::size_t>(n)], n));
  }
  EXPECT_GT(before, 0.05);
  EXPECT_LT(after, 0.2 * before);
  EXPECT_NEAR(map.largest_move_mm, before, 0.5 * before);
}

TEST_F(RefineMap, gives_the_same_bits_on_any_number_of_threads) {
  const RefinedMap one = refine(1);
  for (const std::size_t threads : {2U, 4U}) {
    const RefinedMap more = refine(threads);
    for (std::size_t n = 0; n < one.poses.size(); ++n) EXPECT_EQ(one.poses[n].matrix(), more.poses[n].matrix());
    EXPECT_EQ(one.bow->bow, more.bow->bow);
  }
}

TEST_F(RefineMap, gives_the_same_bits_with_few_keyframes_in_memory) {
  const RefinedMap all = refine();
  scan_.config.nodes_kept = 3;
  const RefinedMap few = refine();
  EXPECT_EQ(all.edges, few.edges);
  for (std::size_t n = 0; n < all.poses.size(); ++n) EXPECT_EQ(all.poses[n].matrix(), few.poses[n].matrix());
  SurfacePatch a = scan_.patches[5], b = scan_.patches[5];
  EXPECT_EQ(all.free_space->withdraw({{}, all.poses[5]}, a), few.free_space->withdraw({{}, few.poses[5]}, b));
}

TEST_F(RefineMap, leaves_poses_alone_where_it_is_not_wanted_or_has_nothing_to_go_by) {
  MapConfig off;
  off.refine = false;
  const RefinedMap map = refine_map(scan_.input, scan_.rig, {}, off);
  for (int n = 0; n < kBursts; ++n) EXPECT_EQ(map.poses[static_cast<std::size_t>(n)].matrix(), tracked(n).matrix());
  for (SurfacePatch& patch : scan_.patches)
    patch = ts::make_patch(ts::SyntheticSurface(99), scan_.rig.camera, ts::looking_down(0, 0, Vec3d::Zero(), 30), {});
  EXPECT_EQ(refine().edges, 0U) << "nothing measured";
}

MapConfig every_two_millimetres() {
  MapConfig config;
  config.spacing_mm = 2;
  config.spacing_deg = 3;
  return config;
}

TEST(KeyframeChoice, one_every_two_millimetres_and_no_crowd_where_the_hand_rests) {
  std::vector<MapBurst> bursts;
  for (int n = 0; n < 30; ++n) bursts.push_back({time_of(n), ts::looking_down(0.5 * n, 0)});
  EXPECT_EQ(choose_keyframes(bursts, 48, every_two_millimetres()).size(), 8U);
  bursts.clear();
  for (int n = 0; n < 400; ++n) bursts.push_back({time_of(n), ts::looking_down(n % 2 == 0 ? 0 : 2.5, 0)});
  EXPECT_LE(choose_keyframes(bursts, 48, every_two_millimetres()).size(), 8U);
}

TEST(KeyframeChoice, pairs_reach_over_passes_but_not_across_the_arch_nor_round_a_tooth) {
  std::vector<MapBurst> bursts;
  std::vector<std::size_t> all;
  for (int n = 0; n < 40; ++n) {
    bursts.push_back({time_of(n < 20 ? n : n + 60), ts::looking_down(2.5 * (n % 20), 0)});
    all.push_back(static_cast<std::size_t>(n));
  }
  const auto pairs = choose_pairs(bursts, all, 48, {});
  std::size_t between = 0;
  for (const KeyframePair& pair : pairs) {
    EXPECT_LT(pair.j, pair.i);
    EXPECT_LE(std::abs(static_cast<int>(pair.i % 20) - static_cast<int>(pair.j % 20)), 3);
    EXPECT_EQ(pair.loop, pair.i != pair.j + 1 || pair.i == 20);
    between += pair.i >= 20 && pair.j < 20 ? 1U : 0U;
  }
  EXPECT_GT(between, 60U);
  bursts[1].T_model_cam = bursts[0].T_model_cam * Eigen::AngleAxisd(1.3, Vec3d::UnitX());
  for (const KeyframePair& pair : choose_pairs(bursts, {0, 1}, 48, {})) EXPECT_NE(pair.i, 1U) << "75 degrees apart";
}

}  // namespace
}  // namespace enamel::pipeline
