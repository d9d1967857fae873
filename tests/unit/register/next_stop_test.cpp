// The planner of stops on a ring about the table's axis: it goes all round, ends by itself, and says what it lacks.
#include "pipeline/register/stops/next_stop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/register/ring_table.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

using Angles = std::vector<calib::AxisAngles>;

constexpr std::uint64_t kSeeds = 2;

/// Coarser than usual, and sooner content: a ring has no crevices, and its limb is seen ever flatter.
PlannerConfig ring_config() {
  PlannerConfig config;
  config.cell_mm = 0.5;
  config.max_incidence_deg = 65;
  config.min_gain = 0.04;
  return config;
}

Angles drive(const ts::RingTable& table, StopPlanner& planner) {
  Angles stops;
  while (const auto next = planner.next()) {
    stops.push_back(*next);
    planner.seen(*next, table.see(*next));
  }
  return stops;
}

Angles all_stops(const PlannerConfig& config) {
  Angles out;
  for (double rot = config.rot_from_deg; rot < config.rot_to_deg; rot += config.rot_step_deg) {
    for (double swing = config.swing_from_deg; swing <= config.swing_to_deg; swing += config.swing_step_deg)
      out.push_back(ts::stop_at(rot, swing));
  }
  return out;
}

/// Of the samples that some stop can show at the limit, those that these stops measured.
double covered(const ts::RingTable& table, const Angles& stops, const PlannerConfig& config) {
  const Angles all = all_stops(config);
  std::size_t can = 0, has = 0;
  const auto any = [&](const Angles& of, const ts::RingTable::Sample& s, double incidence) {
    return std::any_of(of.begin(), of.end(), [&](const auto& a) { return table.shows(a, s, incidence); });
  };
  for (const auto& s : table.samples()) {
    if (!any(all, s, config.max_incidence_deg)) continue;
    ++can;
    has += any(stops, s, 75) ? 1U : 0U;
  }
  return static_cast<double>(has) / static_cast<double>(can);
}

TEST(StopPlanner, ring_is_covered_all_round_by_a_quarter_of_the_candidates) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const ts::RingTable table(seed);
    const PlannerConfig config = ring_config();
    StopPlanner planner(table.mount(), table.rig(), config);
    const Angles stops = drive(table, planner);
    const double share = covered(table, stops, config);
    EXPECT_GE(share, 0.97) << seed;
    EXPECT_LE(stops.size(), 84U) << seed;  // of 48 rotations x 7 swings
    EXPECT_GT(planner.figures().share_seen, 0.95) << seed;
    EXPECT_TRUE(planner.figures().is_complete()) << seed;
    // Control: half of these stops do not cover it.
    EXPECT_LT(
        covered(table, Angles(stops.begin(), stops.begin() + static_cast<std::ptrdiff_t>(stops.size() / 2)), config),
        0.97)
        << seed;
  }
}

TEST(StopPlanner, model_whose_back_was_never_shown_is_not_called_covered) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const ts::RingTable table(seed);
    StopPlanner front(table.mount(), table.rig(), ring_config());
    for (const double swing : {-30.0, 0.0, 30.0}) {
      for (double rot = 0; rot <= 120; rot += 20) {
        const auto angles = ts::stop_at(rot, swing);
        front.seen(angles, table.see(angles));
      }
    }
    EXPECT_TRUE(front.next().has_value()) << seed;
    StopPlanner whole(table.mount(), table.rig(), ring_config());
    static_cast<void>(drive(table, whole));
    EXPECT_LT(front.figures().share_seen, whole.figures().share_seen - 0.02) << seed;
  }
}

TEST(StopPlanner, part_of_a_ring_needs_no_whole_turn) {
  const ts::RingTable half(4, 0.5), whole(4);
  StopPlanner of_half(half.mount(), half.rig(), ring_config()), of_whole(whole.mount(), whole.rig(), ring_config());
  const Angles a = drive(half, of_half), b = drive(whole, of_whole);
  EXPECT_LT(a.size(), b.size());
  EXPECT_GE(covered(half, a, ring_config()), 0.98);
}

TEST(StopPlanner, empty_table_ends_within_one_turn_and_is_told) {
  const ts::RingTable table(1);
  StopPlanner planner(table.mount(), table.rig(), ring_config());
  double last_deg = -1;
  while (const auto next = planner.next()) {
    const double rot = next->rotation() * calib::kDegreesPerRad;
    ASSERT_GT(rot, last_deg);
    ASSERT_LT(rot, 360);
    last_deg = rot;
    planner.seen(*next, {});
  }
  EXPECT_GE(last_deg, 330);
  EXPECT_TRUE(planner.figures().saw_nothing());
  EXPECT_EQ(planner.figures().end, PlanEnd::kNothingSeen);
  EXPECT_EQ(planner.figures().share_seen, 0);
}

TEST(StopPlanner, finds_a_model_that_the_first_stop_does_not_show) {
  const ts::RingTable table(5, 0.2);
  StopPlanner planner(table.mount(), table.rig(), ring_config());
  const Angles stops = drive(table, planner);
  EXPECT_FALSE(planner.figures().saw_nothing());
  EXPECT_GE(covered(table, stops, ring_config()), 0.97);
}

TEST(StopPlanner, told_nothing_new_it_ends) {
  const ts::RingTable table(2);
  PlannerConfig config = ring_config();
  config.max_stops = 1000;
  StopPlanner planner(table.mount(), table.rig(), config);
  const SurfacePatch first = table.see(*planner.next());
  planner.seen(*planner.next(), first);
  const double seen_mm2 = planner.figures().seen_mm2;
  while (const auto next = planner.next()) planner.seen(*next, {});
  EXPECT_LT(planner.figures().stops, 60U);  // of 336 candidates: it gave up, it did not run out of them
  EXPECT_EQ(planner.figures().seen_mm2, seen_mm2);
}

TEST(StopPlanner, asks_for_the_same_stops_again_and_stays_within_its_limits) {
  const ts::RingTable table(3);
  PlannerConfig config = ring_config();
  config.rot_from_deg = 10, config.rot_to_deg = 200;
  config.swing_from_deg = -12, config.swing_to_deg = 12;
  config.max_stops = 20;
  StopPlanner one(table.mount(), table.rig(), config), other(table.mount(), table.rig(), config);
  const Angles a = drive(table, one), b = drive(table, other);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_GT(a.size(), 5U);
  EXPECT_LE(a.size(), 20U);
  EXPECT_EQ(one.figures().end, PlanEnd::kMaxStops) << "half a ring is not shown by 20 stops of a narrow swing";
  EXPECT_FALSE(one.figures().is_complete());
  for (std::size_t n = 0; n < a.size(); ++n) {
    EXPECT_EQ(a[n].rotation(), b[n].rotation());
    EXPECT_EQ(a[n].swing(), b[n].swing());
    const double rot = a[n].rotation() * calib::kDegreesPerRad, swing = a[n].swing() * calib::kDegreesPerRad;
    EXPECT_TRUE(rot > 10 - 1e-9 && rot < 200 + 1e-9 && std::abs(swing) < 12 + 1e-9) << rot << " " << swing;
  }
}

}  // namespace
}  // namespace enamel::pipeline
