// Plans of stops: the named ones, tables of them, and what is wrong with a table.
#include "host/desktop/stop_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace enamel::host {
namespace {

constexpr motion::AxesLimits kLimits{{-0.5, 361}, {-30.5, 31}};

TEST(StopPlan, named_plans_turn_one_way_and_lie_within_the_table) {
  for (const auto& [name, stops] : {std::pair{"full", 72U}, {"quick", 24U}, {"arch", 60U}}) {
    const auto plan = named_plan(name);
    ASSERT_TRUE(plan) << name;
    EXPECT_EQ(plan->size(), stops) << name;
    EXPECT_TRUE(check_plan(*plan, kLimits)) << name;
    for (std::size_t n = 1; n < plan->size(); ++n) {
      const motion::AxesAngles &a = (*plan)[n - 1], &b = (*plan)[n];
      EXPECT_GE(b.rot_deg, a.rot_deg) << name;
      EXPECT_TRUE(a.rot_deg == b.rot_deg || a.swing_deg == b.swing_deg) << name << " " << n;
    }
  }
  const auto none = named_plan("half");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kStopPlan);
  EXPECT_NE(none.error().detail.find("full"), std::string::npos);
}

TEST(StopPlan, table_is_read_in_its_order_however_a_spreadsheet_saves_it) {
  for (const char* text :
       {"rot_deg,swing_deg\n15,-20\n0.5,3\n", "\xEF\xBB\xBFrot_deg;swing_deg\r\n15;-20\r\n0,5;3\r\n"}) {
    const auto plan = parse_plan(text, "p.csv", kLimits);
    ASSERT_TRUE(plan) << plan.error().message();
    ASSERT_EQ(plan->size(), 2U);
    EXPECT_EQ((*plan)[0].rot_deg, 15);
    EXPECT_EQ((*plan)[0].swing_deg, -20);
    EXPECT_EQ((*plan)[1].rot_deg, 0.5);
  }
}

TEST(StopPlan, what_is_wrong_is_told_with_its_line) {
  struct Case {
    const char* text;
    ErrorCode code;
    const char* told;
  };
  for (const Case& c : {Case{"", ErrorCode::kStopPlan, "no stop"},
                        {"rot_deg,swing_deg\n", ErrorCode::kStopPlan, "no stop"},
                        {"0,0\n", ErrorCode::kStopPlan, "p.csv:1: first line"},
                        {"rot_deg,swing_deg\n1,2,3\n", ErrorCode::kStopPlan, "p.csv:2: 3 fields"},
                        {"rot_deg,swing_deg\n1,2\nx,2\n", ErrorCode::kStopPlan, "p.csv:3: rot_deg"},
                        {"rot_deg,swing_deg\n1,\n", ErrorCode::kStopPlan, "p.csv:2: swing_deg"},
                        {"rot_deg,swing_deg\nnan,2\n", ErrorCode::kStopPlan, "p.csv:2: rot_deg"},
                        {"rot_deg,swing_deg\n\n1,2\n", ErrorCode::kStopPlan, "p.csv:2: 1 fields"},
                        {"rot_deg,swing_deg\n1,2\n400,2\n", ErrorCode::kAxesRange, "p.csv:3: rotation 400"},
                        {"rot_deg,swing_deg\n1,-31\n", ErrorCode::kAxesRange, "swing -31"}}) {
    const auto plan = parse_plan(c.text, "p.csv", kLimits);
    ASSERT_FALSE(plan) << c.text;
    EXPECT_EQ(plan.error().code, c.code) << c.text;
    EXPECT_NE(plan.error().detail.find(c.told), std::string::npos) << plan.error().detail;
  }
  EXPECT_EQ(read_plan("/nowhere/p.csv", kLimits).error().code, ErrorCode::kFileNotFound);
}

TEST(StopPlan, plan_outside_a_narrower_table_is_refused_before_anything_moves) {
  const auto plan = named_plan("full");
  const auto result = check_plan(*plan, {{0, 361}, {-15, 15}});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kAxesRange);
  EXPECT_NE(result.error().detail.find("stop 1 of 72: swing -20"), std::string::npos) << result.error().detail;
  EXPECT_EQ(check_plan({}, kLimits).error().code, ErrorCode::kStopPlan);
}

TEST(StopPlan, planner_is_held_within_the_table) {
  const pipeline::PlannerConfig config = within({}, {{5, 300}, {-12, 40}});
  EXPECT_EQ(config.rot_from_deg, 5);
  EXPECT_EQ(config.rot_to_deg, 300);
  EXPECT_EQ(config.swing_from_deg, -12);
  EXPECT_EQ(config.swing_to_deg, 30);
}

}  // namespace
}  // namespace enamel::host
