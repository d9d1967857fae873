// A fast hand: peaks of speed along a pass, turns of the wrist from one burst to the next.
#include <algorithm>

#include "tests/unit/twin/twin_fixture.hpp"

namespace enamel::twin {
namespace {

constexpr double kDistanceMm = 48;

Eigen::Vector3d looked_at(const Trajectory& path, double t) {
  return path.pose_at(t) * Eigen::Vector3d(0, 0, kDistanceMm);
}

struct Speeds {
  double slowest = 1e9, fastest = 0;
};

Speeds speeds(const ArchPathConfig& config, double until_s) {
  const auto path = make_arch_path(config, Arch(ArchShape{}), {});
  Speeds out;
  constexpr double kStep = 0.005;
  for (double t = 0; t + kStep < until_s; t += kStep) {
    const double v = (looked_at(*path, t + kStep) - looked_at(*path, t)).norm() / kStep;
    out.slowest = std::min(out.slowest, v);
    out.fastest = std::max(out.fastest, v);
  }
  return out;
}

TEST(TwinHand, a_surge_swings_the_speed_and_keeps_the_length_of_a_pass) {
  ArchPathConfig config;
  config.passes = {{10, 40, 0, 5}};
  const Speeds even = speeds(config, 2.0);
  EXPECT_NEAR(even.fastest, 15, 0.2);  // negative control
  EXPECT_NEAR(even.slowest, 15, 0.2);
  config.surge_mm_s = 15;
  config.surge_s = 0.7;
  const Speeds surging = speeds(config, 2.0);
  EXPECT_NEAR(surging.fastest, 30, 0.5);
  EXPECT_LT(surging.slowest, 0.5);
  const Arch arch(ArchShape{});
  const auto path = make_arch_path(config, arch, {});
  EXPECT_EQ(path->bursts(), 60);
  EXPECT_NEAR((looked_at(*path, 2.0).head<2>() - arch.point(40)).norm(), 0, 1e-6);
}

TEST(TwinHand, a_spin_turns_the_picture_and_nothing_else) {
  ArchPathConfig config;
  config.passes = {{10, 40, 20, 5}};
  const auto straight = make_arch_path(config, Arch(ArchShape{}), {});
  config.passes.front().spin_deg = 90;
  const auto spun = make_arch_path(config, Arch(ArchShape{}), {});
  for (const double t : {0.0, 0.7, 1.9}) {
    const auto a = straight->pose_at(t), b = spun->pose_at(t);
    EXPECT_EQ(a.translation(), b.translation());
    EXPECT_LT((b.linear().col(0) - a.linear().col(1)).norm(), 1e-12) << "its right is what was below";
    EXPECT_LT((b.linear().col(2) - a.linear().col(2)).norm(), 1e-12);
  }
}

TEST(TwinHand, a_gap_begins_where_it_is_told_to_under_a_surge_too) {
  ArchPathConfig config;
  config.passes = {{40, 10, 0, 5}};
  config.surge_mm_s = 12;
  config.gaps = {{0, 25, 20}};
  const Arch arch(ArchShape{});
  const TimingConfig timing;
  const auto path = make_arch_path(config, arch, timing);
  std::uint64_t behind = 1;
  while (path->slot(behind) == behind) ++behind;
  const double rate = timing.burst_rate_hz;
  const auto left_at = [&](double slot) { return (looked_at(*path, slot / rate).head<2>() - arch.point(25)).norm(); };
  const auto first_left_out = static_cast<double>(behind);
  EXPECT_LT(left_at(first_left_out), 30 / rate);  // less than a burst's way at the highest speed
  EXPECT_GT(left_at(first_left_out + 20), 5);
}

TEST(TwinHand, a_quick_turn_is_more_than_38_degrees_from_burst_to_burst) {
  const auto largest_turn = [](const std::string& turn_s) {
    const auto scene = *load_scene(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/quadrant.toml",
                                   {"path.turn_s=" + turn_s, "effects.tremor=false"});
    const auto path = make_arch_path(scene.arch_path, Arch(ArchShape{}), scene.timing);
    double largest = 0;
    for (int n = 1; n < path->bursts(); ++n) {
      const double before = (n - 1) / scene.timing.burst_rate_hz, after = n / scene.timing.burst_rate_hz;
      const Eigen::Matrix3d R = path->pose_at(before).linear().transpose() * path->pose_at(after).linear();
      largest = std::max(largest, Eigen::AngleAxisd(R).angle() * 180 / testing::kPi);
    }
    return largest;
  };
  EXPECT_GT(largest_turn("0.2"), 45);
  EXPECT_LT(largest_turn("0.9"), 20);  // negative control
}

TEST(TwinHand, a_hand_that_would_go_back_is_refused) {
  const auto scene =
      load_scene(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/quadrant.toml", {"path.surge_mm_s=16.0"});
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message().find("path.surge_mm_s"), std::string::npos);
  EXPECT_TRUE(load_scene(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/quadrant.toml", {"path.surge_mm_s=15.0"}));
}

}  // namespace
}  // namespace enamel::twin
