// The planner of stops on drawn plaster jaws: it shows more of them than the plan `full` by three quarters of its
// stops.
#include <gtest/gtest.h>

#include <vector>

#include "pipeline/register/stops/next_stop.hpp"
#include "tests/support/plaster_table.hpp"

namespace enamel::test {
namespace {

using Stops = std::vector<calib::AxisAngles>;

struct Driven {
  Stops stops;
  pipeline::PlanFigures figures;
};

Driven drive(const PlasterTable& table) {
  pipeline::StopPlanner planner(table.mount(), table.rig(), {});
  Driven out;
  while (const auto next = planner.next()) {
    out.stops.push_back(*next);
    planner.seen(*next, table.see(*next));
  }
  out.figures = planner.figures();
  return out;
}

void check(Plaster kind, std::uint64_t seed, double least_measured) {
  const PlasterTable table(kind, seed);
  const Driven planned = drive(table);
  const Stops full = stops_all_round(15, {-20, 0, 20});
  const ShownSurface goal = shown_by(table, stops_all_round(7.5, {-30, -20, -10, 0, 10, 20, 30}), kShownWell_deg);
  const auto measured = [&](const Stops& stops) { return share_of(shown_by(table, stops, kMeasured_deg), goal); };
  const double share = measured(planned.stops);
  std::printf("%zu stops, measured %.4f, full %.4f, believed %.4f\n", planned.stops.size(), share, measured(full),
              planned.figures.share_seen);
  EXPECT_LE(planned.stops.size(), full.size() * 3 / 4);
  EXPECT_GE(share, least_measured);
  EXPECT_GT(share, measured(full) + 0.005);
  // Control: as many stops without the cradle show less.
  EXPECT_LT(measured(stops_all_round(360.0 / static_cast<double>(planned.stops.size()), {0})), least_measured);
  // What is believed to be seen is not far from what is seen of all that can be.
  EXPECT_NEAR(planned.figures.share_seen, share, 0.04);
}

TEST(PlannerJaw, whole_arch_is_shown_better_than_by_the_full_plan) { check(Plaster::kArch, 21, 0.955); }

TEST(PlannerJaw, quadrant_is_shown_better_than_by_the_full_plan) { check(Plaster::kQuadrant, 22, 0.955); }

}  // namespace
}  // namespace enamel::test
