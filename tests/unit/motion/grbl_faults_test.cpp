// One fault in a move at a time: never settled, what is said, what is known afterwards.
#include <thread>

#include "tests/unit/motion/grbl_fixture.hpp"

namespace enamel::motion {
namespace {

using test::GrblFault;

struct Struck {
  Error error = {};
  AxesState state = AxesState::kReady;
  bool is_over_in_time = false;
  bool was_moving = false;
};

/// A slow move in which the fault happens half way.
Struck strike(GrblBench& bench, GrblFault fault) {
  bench.model.arm(fault, 0.5);
  const HostTime begin = bench.clock.now();
  const auto moved = bench.axes->move_to({60.0, 0.0}, kMove);
  Struck s{.is_over_in_time = bench.clock.now() - begin < kMove + Axes::kStandTime,
           .was_moving = bench.model.is_moving()};
  s.state = bench.axes->state();
  if (!moved) s.error = moved.error();
  EXPECT_FALSE(moved) << "fault " << static_cast<int>(fault) << " passed for a settled move";
  return s;
}

struct Expected {
  GrblFault fault;
  const char* text;
  ErrorCode code = ErrorCode::kAxes;
  AxesState state = AxesState::kUnhomed;
};

class GrblFaults : public ::testing::TestWithParam<Expected> {};

TEST_P(GrblFaults, end_the_move_with_a_reason) {
  GrblBench bench;
  const Struck s = strike(bench, GetParam().fault);
  EXPECT_EQ(s.error.code, GetParam().code);
  EXPECT_NE(s.error.detail.find(GetParam().text), std::string::npos) << s.error.detail;
  EXPECT_EQ(s.state, GetParam().state);
  EXPECT_TRUE(s.is_over_in_time);
  const int moves = bench.model.moves();
  EXPECT_FALSE(bench.axes->move_to({10.0, 0.0}, kMove)) << "a position that is lost needs homing";
  EXPECT_EQ(bench.model.moves(), moves);
}

INSTANTIATE_TEST_SUITE_P(
    Each, GrblFaults,
    ::testing::Values(Expected{GrblFault::kHardLimit, "ALARM:1", ErrorCode::kAxesAlarm},
                      Expected{GrblFault::kRestart, "restarted by itself", ErrorCode::kAxesAlarm},
                      Expected{GrblFault::kPowerOff, "fell silent"},
                      Expected{GrblFault::kUnplug, "cable pulled", ErrorCode::kAxes, AxesState::kLost},
                      Expected{GrblFault::kHang, "fell silent"}, Expected{GrblFault::kNoise, "disturbed"},
                      Expected{GrblFault::kShort, "instead of 60.000", ErrorCode::kAxesStep},
                      Expected{GrblFault::kWander, "instead of 60.000", ErrorCode::kAxesStep},
                      Expected{GrblFault::kOtherTarget, "instead of 60.000", ErrorCode::kAxesStep},
                      Expected{GrblFault::kOkInMove, "state Run where it should stand"},
                      Expected{GrblFault::kDoor, "state Door", ErrorCode::kAxesAlarm}));

TEST(GrblFaultsAlone, a_lie_about_standing_and_one_bad_byte_do_no_harm) {
  for (const GrblFault fault : {GrblFault::kIdleInMove, GrblFault::kOneBadByte}) {
    GrblBench bench;
    bench.model.arm(fault, 0.2);
    const auto moved = bench.axes->move_to({60.0, 0.0}, kMove);
    EXPECT_FALSE(bench.model.is_moving());
    EXPECT_TRUE(moved) << moved.error().message();
  }
}

TEST(GrblFaultsAlone, a_lost_ok_ends_at_the_deadline) {
  GrblBench bench;
  bench.model.arm(GrblFault::kLostOk, 0.2);
  const auto moved = bench.axes->move_to({60.0, 0.0}, std::chrono::seconds(1));
  ASSERT_FALSE(moved);
  EXPECT_NE(moved.error().detail.find("no `ok`"), std::string::npos) << moved.error().detail;
  EXPECT_FALSE(bench.model.is_moving());
}

TEST(GrblFaultsAlone, a_target_altered_beyond_the_travel_is_stopped_on_its_way) {
  GrblProfile profile = quick_profile();
  profile.feed_deg_per_s = 40.0;
  profile.rot.max_deg = 20.0;
  GrblBench bench({}, profile);
  bench.model.arm(GrblFault::kFarTarget, 0.0);
  const auto moved = bench.axes->move_to({10.0, -29.0}, kMove);
  ASSERT_FALSE(moved);
  EXPECT_NE(moved.error().detail.find("left its travel"), std::string::npos) << moved.error().detail;
  EXPECT_FALSE(bench.model.is_moving());
  const double farthest_deg = bench.model.range().second[0] + 399.0;
  EXPECT_LT(farthest_deg, 60.0) << "it was on its way to 394 degrees";
  EXPECT_GT(farthest_deg, 20.0) << "negative control: it did leave";
}

TEST(GrblFaultsAlone, homing_that_fails_says_why_and_leaves_the_axes_unhomed) {
  GrblBench bench({.homing_alarm = 9}, quick_profile(), false);
  const auto homed = bench.axes->home(kMove);
  ASSERT_FALSE(homed);
  EXPECT_EQ(homed.error().code, ErrorCode::kAxesAlarm);
  EXPECT_NE(homed.error().detail.find("ALARM:9"), std::string::npos);
  EXPECT_NE(homed.error().detail.find("no switch found"), std::string::npos);
  EXPECT_EQ(bench.axes->state(), AxesState::kUnhomed);
  EXPECT_FALSE(bench.axes->move_to({10.0, 0.0}, kMove));
  EXPECT_EQ(bench.model.moves(), 0);
}

TEST(GrblFaultsAlone, a_home_that_contradicts_the_soft_limits_is_refused) {
  GrblBench bench({.settings = {{130, 200}}}, quick_profile(), false);
  const auto homed = bench.axes->home(kMove);
  ASSERT_FALSE(homed);
  EXPECT_EQ(homed.error().code, ErrorCode::kConfigValue);
  EXPECT_NE(homed.error().detail.find("$130"), std::string::npos) << homed.error().detail;
  EXPECT_EQ(bench.axes->state(), AxesState::kUnhomed);
}

TEST(GrblFaultsAlone, a_locked_controller_is_told) {
  GrblBench bench({.is_locked_after_home = true});
  const auto moved = bench.axes->move_to({10.0, 0.0}, kMove);
  ASSERT_FALSE(moved);
  EXPECT_NE(moved.error().detail.find("error:9: locked"), std::string::npos) << moved.error().detail;
}

TEST(GrblFaultsAlone, after_a_restart_homing_makes_the_axes_usable_again) {
  GrblBench bench;
  static_cast<void>(strike(bench, GrblFault::kRestart));
  ASSERT_TRUE(bench.axes->home(kMove));
  const auto moved = bench.axes->move_to({60.0, 0.0}, kMove);
  ASSERT_TRUE(moved) << moved.error().message();
  EXPECT_NEAR(bench.model.position()[0], 60.0 - 399.0, 0.002);
}

TEST(GrblFaultsAlone, unplugged_at_rest_is_told_by_the_next_call) {
  GrblBench bench;
  static_cast<void>(strike(bench, GrblFault::kUnplug));
  EXPECT_EQ(bench.axes->state(), AxesState::kLost);
  EXPECT_FALSE(bench.axes->home(kMove));
  EXPECT_FALSE(bench.axes->stop());
  EXPECT_FALSE(bench.axes->position());
}

}  // namespace
}  // namespace enamel::motion
