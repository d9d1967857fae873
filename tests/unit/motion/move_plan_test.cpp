#include "host/motion/move_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "protocol/base/rng.hpp"

namespace enamel::motion {
namespace {

constexpr AxesLimits kLimits{{0.0, 360.0}, {-30.0, 30.0}};
constexpr ApproachRule kRule{.overshoot_deg = 0.5, .same_deg = 0.001};

TEST(MovePlan, targets_outside_or_without_value_are_refused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const AxesAngles bad :
       {AxesAngles{kNan, 0.0}, AxesAngles{0.0, kNan}, AxesAngles{kInf, 0.0}, AxesAngles{0.0, -kInf},
        AxesAngles{360.001, 0.0}, AxesAngles{-0.001, 0.0}, AxesAngles{0.0, 30.001}}) {
    const auto checked = check_target(bad, kLimits);
    ASSERT_FALSE(checked) << bad.rot_deg << " " << bad.swing_deg;
    EXPECT_EQ(checked.error().code, ErrorCode::kAxesRange);
  }
  EXPECT_TRUE(check_target({0.0, -30.0}, kLimits));
  EXPECT_TRUE(check_target({360.0, 30.0}, kLimits));
}

TEST(MovePlan, a_way_up_is_direct_and_a_way_down_overshoots) {
  const AxesPlace from{{100.0, true}, {0.0, true}};
  EXPECT_EQ(way_to({120.0, 10.0}, from, kRule).size(), 1U);
  const auto down = way_to({80.0, 10.0}, from, kRule);
  ASSERT_EQ(down.size(), 2U);
  EXPECT_DOUBLE_EQ(down[0].rot_deg, 79.5);
  EXPECT_DOUBLE_EQ(down[0].swing_deg, 0.0) << "the other axis waits";
  EXPECT_TRUE(way_to({100.0, 0.0}, from, kRule).empty()) << "it stands there";
}

TEST(MovePlan, play_on_an_unknown_side_is_taken_up_even_for_a_small_way_up) {
  const AxesPlace from{{100.0, false}, {0.0, true}};
  EXPECT_EQ(way_to({100.0, 0.0}, from, kRule).size(), 2U);
  EXPECT_EQ(way_to({100.2, 0.0}, from, kRule).size(), 2U);
  EXPECT_EQ(way_to({101.0, 0.0}, from, kRule).size(), 1U);
}

TEST(MovePlan, drawn_ways_end_upwards_and_stay_within_the_travel) {
  Rng rng(11, 0, 0);
  const AxesLimits travel{{-1.0, 361.0}, {-31.0, 31.0}};
  int detours = 0;
  for (int i = 0; i < 5000; ++i) {
    const ApproachRule rule{.overshoot_deg = rng.uniform(0.1, 2.0), .same_deg = 0.001};
    const AxesLimits allowed = target_limits(travel, rule.overshoot_deg);
    const auto draw = [&](const AxisLimits& l) { return rng.uniform(l.min_deg, l.max_deg); };
    const AxesPlace from{{draw(travel.rot), rng.below(2) == 0}, {draw(travel.swing), rng.below(2) == 0}};
    const AxesAngles target{draw(allowed.rot), draw(allowed.swing)};
    ASSERT_TRUE(check_target(target, allowed));
    const auto way = way_to(target, from, rule);
    ASSERT_FALSE(way.empty());
    detours += way.size() == 2 ? 1 : 0;
    AxesAngles before{from.rot.at_deg, from.swing.at_deg};
    for (const AxesAngles& p : way) {
      ASSERT_TRUE(check_target(p, travel));
      if (&p != &way.back()) before = p;
    }
    ASSERT_GE(target.rot_deg, before.rot_deg);
    ASSERT_GE(target.swing_deg, before.swing_deg);
  }
  EXPECT_GT(detours, 2000);
  // Negative control: without the rule ways do end downwards.
  const auto way = way_to({80.0, 0.0}, {{100.0, true}, {0.0, true}}, {.overshoot_deg = 0.0, .same_deg = 0.001});
  ASSERT_EQ(way.size(), 1U);
  EXPECT_LT(way[0].rot_deg, 100.0);
}

}  // namespace
}  // namespace enamel::motion
