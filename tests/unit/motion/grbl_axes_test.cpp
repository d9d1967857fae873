#include <cmath>
#include <limits>
#include <thread>

#include "tests/unit/motion/grbl_fixture.hpp"

namespace enamel::motion {
namespace {

TEST(GrblAxes, goes_where_it_is_told_and_returns_when_it_stands) {
  GrblBench bench;
  for (const AxesAngles target : {AxesAngles{90.0, 0.0}, AxesAngles{30.0, 20.0}, AxesAngles{200.1234, -10.5}}) {
    const auto at = bench.axes->move_to(target, kMove);
    ASSERT_TRUE(at) << at.error().message();
    EXPECT_FALSE(bench.model.is_moving());
    EXPECT_TRUE(bench.model.came_from_below());
    EXPECT_NEAR(at->read.rot_deg, target.rot_deg, 0.002);
    EXPECT_NEAR(at->read.swing_deg, target.swing_deg, 0.002);
    EXPECT_NEAR(bench.model.position()[0], target.rot_deg - 399.0, 0.002) << "home is -399 units";
    EXPECT_NEAR(bench.model.position()[1], target.swing_deg - 39.0, 0.002);
  }
}

TEST(GrblAxes, negative_control_without_overshoot_it_comes_from_above) {
  GrblProfile profile = quick_profile();
  profile.overshoot_deg = 0.0;
  GrblBench bench({}, profile);
  ASSERT_TRUE(bench.axes->move_to({90.0, 0.0}, kMove));
  ASSERT_TRUE(bench.axes->move_to({30.0, 0.0}, kMove));
  EXPECT_FALSE(bench.model.came_from_below());
}

TEST(GrblAxes, negative_control_ok_alone_does_not_mean_standing) {
  SteadyClock clock;
  test::GrblModel model;
  auto link = GrblLink::open(model.port(), std::chrono::milliseconds(600), clock);
  ASSERT_TRUE(link);
  ASSERT_TRUE((*link)->command("$H", {.within = kMove}));
  ASSERT_TRUE((*link)->command("G90 G21 G94 G53 G1 X-300 Y-69 F20000", {.within = kMove}));
  EXPECT_TRUE(model.is_moving()) << "the model would show whoever returned here";
  EXPECT_FALSE(model.was_told_to_move_before_home());
}

TEST(GrblAxes, negative_control_the_model_tells_of_a_move_before_home) {
  SteadyClock clock;
  test::GrblModel model;
  auto link = GrblLink::open(model.port(), std::chrono::milliseconds(600), clock);
  ASSERT_TRUE(link);
  EXPECT_FALSE((*link)->command("G90 G21 G94 G53 G1 X-1 Y-1 F20000", {.within = kMove})) << "error:9";
  EXPECT_TRUE(model.was_told_to_move_before_home());
}

TEST(GrblAxes, nothing_moves_before_home) {
  GrblBench bench({}, quick_profile(), false);
  const auto moved = bench.axes->move_to({10.0, 0.0}, kMove);
  ASSERT_FALSE(moved);
  EXPECT_NE(moved.error().detail.find("home first"), std::string::npos);
  EXPECT_EQ(bench.model.moves(), 0);
  EXPECT_FALSE(bench.axes->position());
}

TEST(GrblAxes, targets_outside_the_limits_send_nothing) {
  GrblBench bench;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const AxesAngles bad :
       {AxesAngles{kNan, 0.0}, AxesAngles{361.1, 0.0}, AxesAngles{-0.6, 0.0}, AxesAngles{0.0, 31.1}}) {
    const auto moved = bench.axes->move_to(bad, kMove);
    ASSERT_FALSE(moved);
    EXPECT_EQ(moved.error().code, ErrorCode::kAxesRange);
  }
  EXPECT_EQ(bench.model.moves(), 0);
  EXPECT_EQ(bench.axes->state(), AxesState::kReady) << "a refusal costs no position";
}

TEST(GrblAxes, a_stop_from_another_thread_keeps_the_position) {
  GrblProfile profile = quick_profile();
  profile.feed_deg_per_s = 60.0;
  GrblBench bench({}, profile);
  std::thread other([&] {
    while (!bench.model.is_moving()) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    bench.axes->request_stop();
  });
  const auto moved = bench.axes->move_to({200.0, 0.0}, kMove);
  other.join();
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, ErrorCode::kCancelled);
  EXPECT_FALSE(bench.model.is_moving());
  ASSERT_EQ(bench.axes->state(), AxesState::kReady);
  const auto at = bench.axes->position();
  ASSERT_TRUE(at) << at.error().message();
  EXPECT_LT(at->read.rot_deg, 100.0);
  const auto again = bench.axes->move_to({50.0, 0.0}, kMove);
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_NEAR(bench.model.position()[0], 50.0 - 399.0, 0.002);
  EXPECT_TRUE(bench.model.came_from_below());
}

TEST(GrblAxes, a_move_that_takes_too_long_ends_at_its_time_and_stands) {
  GrblProfile profile = quick_profile();
  profile.feed_deg_per_s = 20.0;
  GrblBench bench({}, profile);
  const HostTime begin = bench.clock.now();
  const auto moved = bench.axes->move_to({300.0, 0.0}, std::chrono::milliseconds(500));
  ASSERT_FALSE(moved);
  EXPECT_LT(bench.clock.now() - begin, std::chrono::milliseconds(500) + Axes::kStandTime);
  EXPECT_FALSE(bench.model.is_moving());
  EXPECT_EQ(bench.axes->state(), AxesState::kUnhomed);
}

TEST(GrblAxes, stop_at_rest_keeps_the_position) {
  GrblBench bench;
  ASSERT_TRUE(bench.axes->move_to({45.0, 5.0}, kMove));
  ASSERT_TRUE(bench.axes->stop());
  EXPECT_EQ(bench.axes->state(), AxesState::kReady);
  const auto moved = bench.axes->move_to({46.0, 5.0}, kMove);
  EXPECT_TRUE(moved) << moved.error().message();
}

TEST(GrblAxes, a_motor_that_turns_the_other_way_has_a_negative_unit) {
  // Rotation homes at 0 to the negative end: angles 0 to -360 are units upwards.
  GrblProfile profile = quick_profile();
  profile.rot.deg_per_unit = -1.0;
  profile.rot.min_deg = -361.0;
  profile.rot.max_deg = 1.0;
  GrblBench bench({}, profile);
  const auto at = bench.axes->move_to({-90.0, 0.0}, kMove);
  ASSERT_TRUE(at) << at.error().message();
  EXPECT_NEAR(bench.model.position()[0], 90.0 - 399.0, 0.002);
}

}  // namespace
}  // namespace enamel::motion
