// What the tracker expects of the next burst, and which bursts it keeps to find its place again.
#include "pipeline/register/track/motion_model.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "pipeline/register/track/keyframes.hpp"
#include "tests/unit/register/burst_times.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

TEST(MotionModel, carries_mean_velocity_on_and_stops_in_time) {
  MotionModel motion({});
  for (int n = 0; n < 4; ++n) motion.add(time_of(n), ts::looking_down(10 * seconds_of(n), 0));
  const auto x_at = [&](int n) { return (motion.predict(time_of(n)) * Vec3d(0, 0, 48)).x(); };
  EXPECT_NEAR(x_at(4), 10 * seconds_of(4), 1e-9);
  EXPECT_NEAR(x_at(5), 10 * seconds_of(5), 1e-9);
  EXPECT_NEAR(x_at(20), 10 * (seconds_of(3) + 0.1), 1e-9);
}

TEST(MotionModel, the_bursts_own_velocity_is_the_prior_of_the_next) {
  const ProbeTwist twist{{4, 0, 0}, {0, 0, 0.5}, 40};  // turns about the optical axis: the work point only shifts
  MotionModel ignorant({});
  ignorant.add(time_of(0), ts::looking_down(0, 0));
  EXPECT_FALSE(ignorant.predict_by_twist(time_of(1)).has_value());
  MotionModel fresh({});
  fresh.add(time_of(0), ts::looking_down(0, 0), twist);
  const Pose one = ts::looking_down(0, 0).inverse() * fresh.predict(time_of(1));
  EXPECT_NEAR((one * Vec3d(0, 0, 48)).x(), 4 * seconds_of(1), 1e-9);
  EXPECT_NEAR(Eigen::AngleAxisd(one.linear()).angle(), 0.5 * seconds_of(1), 1e-9);
  // With a history, half of each; alone where it is asked for.
  MotionModel moving({});
  for (int n = 0; n < 4; ++n) moving.add(time_of(n), ts::looking_down(0, 0), twist);
  const auto ahead = [&](const Pose& T) { return (ts::looking_down(0, 0).inverse() * T * Vec3d(0, 0, 48)).x(); };
  EXPECT_NEAR(ahead(moving.predict(time_of(4))), 2 * seconds_of(1), 1e-9);
  EXPECT_NEAR(ahead(*moving.predict_by_twist(time_of(4))), 4 * seconds_of(1), 1e-9);
}

TEST(MotionModel, is_the_same_motion_in_another_frame) {
  MotionModel motion({}), moved({});
  const Pose T_other_model = ts::looking_down(7, -3, {0.4, 0.2, -0.9});
  for (int n = 0; n < 4; ++n) {
    motion.add(time_of(n), ts::looking_down(0.3 * n, 0.1 * n));
    moved.add(time_of(n), ts::looking_down(0.3 * n, 0.1 * n));
  }
  moved.carry_into(T_other_model);
  EXPECT_TRUE(moved.predict(time_of(5)).isApprox(T_other_model * motion.predict(time_of(5)), 1e-9));
}

TEST(MotionModel, a_twist_about_another_point_moves_the_work_point_by_its_lever) {
  MotionModel motion({});
  motion.add(time_of(0), Pose::Identity(), ProbeTwist{{0, 0, 0}, {0, 0.1, 0}, 40});
  const Vec3d moved = *motion.predict_by_twist(time_of(1)) * Vec3d(0, 0, 48);
  EXPECT_NEAR(moved.x(), 8 * 0.1 * seconds_of(1), 1e-4);
  EXPECT_NEAR((*motion.predict_by_twist(time_of(1)) * Vec3d(0, 0, 40) - Vec3d(0, 0, 40)).norm(), 0, 1e-4);
}

TEST(MotionModel, time_that_stands_still_or_runs_backwards_predicts_the_last_pose) {
  MotionModel motion({});
  for (int n = 0; n < 4; ++n) motion.add(time_of(n), ts::looking_down(10 * seconds_of(n), 0));
  EXPECT_EQ(motion.predict(time_of(3)).matrix(), motion.last_pose().matrix());
  EXPECT_EQ(motion.predict(time_of(1)).matrix(), motion.last_pose().matrix());
}

TEST(Keyframes, are_spaced_in_place_and_angle) {
  KeyframeStore store(ts::test_rig().camera, {});
  const SurfacePatch nothing =
      ts::make_patch(ts::SyntheticSurface(1), ts::test_rig(8).camera, ts::looking_down(0, 0), {});
  EXPECT_TRUE(store.wants(ts::looking_down(0, 0)));
  store.add(nothing, ts::looking_down(0, 0), {});
  EXPECT_FALSE(store.wants(ts::looking_down(1.9, 0)));
  EXPECT_TRUE(store.wants(ts::looking_down(2.1, 0)));
  EXPECT_TRUE(store.wants(ts::looking_down(0, 0, {0, 0.06, 0})));
}

TEST(Keyframes, every_one_is_tried_within_a_few_bursts) {
  KeyframeStore store(ts::test_rig(8).camera, {});
  const SurfacePatch nothing =
      ts::make_patch(ts::SyntheticSurface(1), ts::test_rig(8).camera, ts::looking_down(0, 0), {});
  for (int i = 0; i < 70; ++i) store.add(nothing, ts::looking_down(3.0 * i, 0), {});
  std::vector<int> tried(70, 0);
  for (std::uint64_t turn = 0; turn < 4; ++turn) {
    const auto chosen = store.candidates(ts::looking_down(0, 0), turn, 32);
    EXPECT_LE(chosen.size(), 32U);
    for (const std::size_t i : chosen) ++tried[i];
  }
  for (int i = 0; i < 70; ++i) EXPECT_GT(tried[static_cast<std::size_t>(i)], 0) << i;
}

}  // namespace
}  // namespace enamel::pipeline
