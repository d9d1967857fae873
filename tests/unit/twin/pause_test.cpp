// Pauses of the probe on the way along an arch: bursts left out, numbers without a hole, time and hand going on.
#include <cstddef>

#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/path/burst_slots.hpp"

namespace enamel::twin {
namespace {

constexpr double kRateHz = 15;

SceneConfig arch_scene() {
  SceneConfig scene;
  scene.object = ObjectKind::kJaw;
  scene.path = PathKind::kArch;
  scene.jaw.from_mm = 30;
  scene.jaw.to_mm = 32;
  scene.jaw.max_edge_mm = 1;
  scene.timing.burst_rate_hz = kRateHz;
  scene.effects.tremor = false;
  scene.arch_path.passes = {{10, 40, 0, 5}};
  return scene;
}

/// Largest way of the probe from one burst to the next.
double longest_step(const TwinSource& source) {
  double longest = 0;
  for (std::uint64_t n = 1; n < *source.count(); ++n) {
    const Vec3d before = source.poses(n - 1).mid.translation(), after = source.poses(n).mid.translation();
    longest = std::max(longest, (after - before).norm());
  }
  return longest;
}

std::string error_of(const std::string& path) {
  auto reader = ConfigReader::from_text("[object]\ntype='jaw'\n[path]\ntype='arch'\n" + path, "test.toml");
  if (!reader) return reader.error().message();
  SceneConfig c;
  bind_scene(*reader, c);
  const auto done = reader->finish();
  return done ? "" : done.error().message();
}

TEST(TwinPause, slots_leave_out_what_is_quiet) {
  const BurstSlots slots({{7, 9}, {2, 4}, {3, 5}, {-3, 1}});  // 0, 2 … 4, 7, 8
  const std::vector<std::uint64_t> expected{1, 5, 6, 9, 10};
  for (std::size_t n = 0; n < expected.size(); ++n) EXPECT_EQ(slots.slot(n), expected[n]);
  EXPECT_EQ(slots.bursts_within(11), 5);
  EXPECT_EQ(slots.bursts_within(3), 1);
  EXPECT_EQ(BurstSlots({}).slot(4), 4U);
}

TEST(TwinPause, a_gap_leaves_out_bursts_and_time_and_hand_go_on) {
  SceneConfig scene = arch_scene();
  const auto whole = testing::source_of(scene, testing::small_rig());
  scene.arch_path.gaps = {{0, 20, 14}};
  const auto gapped = testing::source_of(scene, testing::small_rig());
  ASSERT_EQ(*whole->count(), 30U);
  ASSERT_EQ(*gapped->count(), 16U);
  constexpr std::uint64_t kFirstBehind = 10;  // 20 mm are reached after 10 mm, at 1 mm a burst
  for (std::uint64_t n = 0; n < *gapped->count(); ++n) {
    const std::uint64_t same = n < kFirstBehind ? n : n + 14;
    EXPECT_EQ(gapped->t_mid_ns(n), whole->t_mid_ns(same)) << n;
    EXPECT_EQ(gapped->poses(n).mid.matrix(), whole->poses(same).mid.matrix()) << n;
  }
  EXPECT_GT(longest_step(*gapped), 12);
  EXPECT_LT(longest_step(*whole), 3);  // negative control: without the gap nothing leaps
}

TEST(TwinPause, bursts_are_numbered_on_and_their_stamps_leap) {
  SceneConfig scene = arch_scene();
  scene.arch_path.gaps = {{0, 12, 14}};
  scene.timing.bursts = 4;
  const auto source = testing::source_of(scene, testing::small_rig());
  std::vector<std::int64_t> starts;
  for (std::uint64_t n = 0; n < 4; ++n) {
    const auto burst = source->next();
    ASSERT_TRUE(burst && burst->has_value());
    EXPECT_EQ((*burst)->burst_index, n);
    EXPECT_EQ(source->truth().t_mid_ns, source->t_mid_ns(n));
    starts.push_back((*burst)->t_exposure_ns[0]);
  }
  EXPECT_NEAR(static_cast<double>(starts[1] - starts[0]), 1e9 / kRateHz, 2);
  EXPECT_NEAR(static_cast<double>(starts[2] - starts[1]), 15e9 / kRateHz, 2);
}

TEST(TwinPause, a_pass_behind_a_pause_begins_at_its_own_place_and_angle) {
  SceneConfig scene = arch_scene();
  PassConfig back{22, 40, -40, 5};
  back.after = Joint::kPause;
  back.pause_s = 1.0;
  scene.arch_path.passes = {{10, 30, 0, 5}, back};
  const auto source = testing::source_of(scene, testing::small_rig());
  const double all_s = 20 / 15.0 + 1.0 + 18 / 15.0;
  const auto slots = static_cast<std::uint64_t>(all_s * kRateHz);
  ASSERT_LT(*source->count(), slots - 13);
  std::uint64_t behind = 0;
  for (std::uint64_t n = 1; n < *source->count(); ++n) {
    if (source->t_mid_ns(n) - source->t_mid_ns(n - 1) > 500'000'000) behind = n;
  }
  ASSERT_GT(behind, 0U);
  const auto angle = [&](std::uint64_t n) {
    const Pose before = source->poses(n - 1).mid, after = source->poses(n).mid;
    return Eigen::AngleAxisd(Eigen::Matrix3d(before.linear().transpose() * after.linear())).angle();
  };
  EXPECT_GT(angle(behind), 39 * testing::kPi / 180);
  for (std::uint64_t n = 1; n < *source->count(); ++n) {
    if (n == behind) continue;
    EXPECT_LT(angle(n), 6 * testing::kPi / 180) << n;  // what the arch's bend makes of 1 mm
  }
  // No burst sees the leap: within each the probe moves by no more than the hand's speed allows.
  for (std::uint64_t n = 0; n < *source->count(); ++n) {
    const BurstPoses p = source->poses(n);
    EXPECT_LT((p.frames[3].back().translation() - p.frames[0].front().translation()).norm(), 1.0) << n;
  }
}

TEST(TwinPause, a_stretch_of_the_way_is_that_of_the_whole) {
  SceneConfig scene = arch_scene();
  const auto whole = testing::source_of(scene, testing::small_rig());
  scene.arch_path.from_s = 1.0;
  const auto part = testing::source_of(scene, testing::small_rig());
  ASSERT_EQ(*part->count(), 15U);
  EXPECT_EQ(part->t_mid_ns(0), whole->t_mid_ns(15));
  EXPECT_EQ(part->poses(3).mid.matrix(), whole->poses(18).mid.matrix());
  scene.arch_path.from_s = 2.0;
  const auto none = TwinSource::create(scene, testing::small_rig());
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kConfigValue);
}

TEST(TwinPause, the_scenes_pause_as_often_as_they_say) {
  const auto leaps_of = [](const std::string& name) {
    const auto scene = *load_scene(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/" + name + ".toml");
    const auto path = make_arch_path(scene.arch_path, Arch(ArchShape{}), scene.timing);
    std::vector<std::uint64_t> leaps;
    for (std::uint64_t n = 1; n < static_cast<std::uint64_t>(path->bursts()); ++n) {
      if (const std::uint64_t left_out = path->slot(n) - path->slot(n - 1) - 1; left_out > 0) leaps.push_back(left_out);
    }
    return leaps;
  };
  const auto gaps = leaps_of("gaps");
  EXPECT_EQ(gaps.size(), 5U);
  for (const std::uint64_t left_out : gaps) EXPECT_NEAR(static_cast<double>(left_out), 14, 1);
  EXPECT_EQ(leaps_of("arch").size(), 1U);
  EXPECT_EQ(leaps_of("arch_upper").size(), 1U);
  EXPECT_EQ(leaps_of("quadrant").size(), 0U);
}

TEST(TwinPause, mistakes_are_named) {
  const std::string pass = "[[path.pass]]\nfrom_mm=30.0\nto_mm=10.0\n";
  EXPECT_EQ(error_of(pass + "[[path.gap]]\nat_mm=20.0\n"), "");
  EXPECT_NE(error_of(pass + "[[path.gap]]\nat_mm=31.0\n").find("path.gap[0].at_mm"), std::string::npos);
  EXPECT_NE(error_of(pass + "[[path.gap]]\nat_mm=20.0\npass=1\n").find("path.gap[0].pass"), std::string::npos);
  EXPECT_NE(error_of(pass + "[[path.gap]]\nat_mm=20.0\nbursts=0\n").find("path.gap[0].bursts"), std::string::npos);
  EXPECT_NE(error_of(pass + "after='pause'\n").find("path.pass[0].after"), std::string::npos);
  EXPECT_EQ(error_of(pass + pass + "after='pause'\n"), "");
  EXPECT_NE(error_of(pass + pass + "after='rest'\n").find("path.pass[1].after"), std::string::npos);
  EXPECT_NE(error_of(pass + "[[path.gap]]\nat_mm=20.0\nburst=3\n").find("burst"), std::string::npos);
}

}  // namespace
}  // namespace enamel::twin
