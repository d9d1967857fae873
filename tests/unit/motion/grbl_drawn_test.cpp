// Random faults at random moments of many moves. Whatever happens: no move is called settled while the axis runs or
// stands elsewhere, nothing runs before home or beyond the travel, and every call ends in its time.
#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/base/rng.hpp"
#include "tests/unit/motion/grbl_fixture.hpp"

namespace enamel::motion {
namespace {

using test::GrblFault;

constexpr std::array kFaults{
    GrblFault::kHardLimit,   GrblFault::kRestart,    GrblFault::kPowerOff, GrblFault::kUnplug, GrblFault::kHang,
    GrblFault::kNoise,       GrblFault::kOneBadByte, GrblFault::kLostOk,   GrblFault::kShort,  GrblFault::kWander,
    GrblFault::kOtherTarget, GrblFault::kIdleInMove, GrblFault::kOkInMove, GrblFault::kDoor};

struct Tally {
  int settled = 0;
  int failed = 0;
};

void check_within_travel(const test::GrblModel& model) {
  EXPECT_FALSE(model.was_told_to_move_before_home());
  const auto [low, high] = model.range();
  EXPECT_GE(low[0], -400.0 - 0.01);
  EXPECT_LE(high[0], -38.0 + 0.01);
  EXPECT_GE(low[1], -70.0 - 0.01);
  EXPECT_LE(high[1], -8.0 + 0.01);
}

void move_once(GrblBench& bench, Rng& rng, Tally& tally) {
  if (rng.below(3) == 0) bench.model.arm(kFaults[rng.below(kFaults.size())], rng.uniform());
  const AxesAngles target{rng.uniform(-0.5, 361.0), rng.uniform(-30.5, 31.0)};
  const Nanoseconds within = std::chrono::milliseconds(500 + rng.below(1500));
  const HostTime begin = bench.clock.now();
  const auto at = bench.axes->move_to(target, within);
  const bool was_moving = bench.model.is_moving();
  const auto stands = bench.model.position();
  EXPECT_LT(bench.clock.now() - begin, within + Axes::kStandTime);
  at ? ++tally.settled : ++tally.failed;
  if (!at) {
    EXPECT_FALSE(at.error().detail.empty());
    EXPECT_NE(bench.axes->state(), AxesState::kReady) << at.error().detail;
    return;
  }
  EXPECT_FALSE(was_moving) << "reported settled while moving";
  EXPECT_NEAR(stands[0], target.rot_deg - 399.0, 0.003);
  EXPECT_NEAR(stands[1], target.swing_deg - 39.0, 0.003);
  EXPECT_TRUE(bench.model.came_from_below());
}

class GrblDrawn : public ::testing::TestWithParam<unsigned> {};

TEST_P(GrblDrawn, faults_never_pass_for_a_settled_move) {
  Rng rng(GetParam(), 0, 0);
  Tally tally;
  for (int session = 0; session < 4; ++session) {
    GrblBench bench({.seed = GetParam() * 100 + static_cast<unsigned>(session)});
    for (int i = 0; i < 8; ++i) {
      if (bench.axes->state() == AxesState::kUnhomed && !bench.axes->home(std::chrono::seconds(2))) break;
      if (bench.axes->state() != AxesState::kReady) break;
      move_once(bench, rng, tally);
    }
    check_within_travel(bench.model);
  }
  EXPECT_GT(tally.settled, 5);
  EXPECT_GT(tally.failed, 3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, GrblDrawn, ::testing::Values(1U, 2U));

}  // namespace
}  // namespace enamel::motion
