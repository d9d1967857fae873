// The planner of the desktop scanner's stops beside the fixed plans, on drawn plaster models: how much of what any stop
// could show is shown, and by how many stops. Prints a table; --json FILE writes it, too; --seeds N, 6 by
// default. Seen can be what at least three of the stops that the planner chooses from would measure.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/register/stops/next_stop.hpp"
#include "protocol/base/file.hpp"
#include "tests/support/plaster_table.hpp"

namespace enamel::bench {
namespace {

using test::PlasterTable;
using test::ShownSurface;
using Stops = std::vector<calib::AxisAngles>;

constexpr double kStop_s = 0.4;  // settling and four bursts
constexpr std::uint16_t kSafeViews =
    3;  // what fewer stops of the grid measure is a sliver that a stop between them loses

struct Row {
  std::string model, plan;
  std::uint64_t seed = 0;
  double all_mm2 = 0;         ///< what any of the planner's candidates measures
  double shown_share = 0;     ///< of what any shows at 65 degrees or better, by these stops at 65 degrees
  double any_share = 0;       ///< measured, of what any candidate measures …
  double measured_share = 0;  ///< … and of what three of them do
  std::size_t stops = 0;
  double taking_s = 0;
  double believed_share = 0;  ///< PlanFigures::share_seen
  bool is_complete = false;   ///< PlanFigures::is_complete
  double slowest_ms = 0;      ///< of the planner's answers
};

double seconds(const Stops& stops, const pipeline::PlannerConfig& config) {
  double sum = kStop_s * static_cast<double>(stops.size());
  for (std::size_t n = 1; n < stops.size(); ++n) {
    const double way = std::max(std::abs(stops[n].rotation() - stops[n - 1].rotation()),
                                std::abs(stops[n].swing() - stops[n - 1].swing()));
    sum += way * calib::kDegreesPerRad / config.speed_deg_per_s;
  }
  return sum;
}

Stops plan(const PlasterTable& table, const pipeline::PlannerConfig& config, Row& row) {
  pipeline::StopPlanner planner(table.mount(), table.rig(), config);
  Stops stops;
  while (const auto next = planner.next()) {
    stops.push_back(*next);
    const SurfacePatch patch = table.see(*next);
    const auto began = std::chrono::steady_clock::now();
    planner.seen(*next, patch);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - began;
    row.slowest_ms = std::max(row.slowest_ms, took.count());
  }
  row.believed_share = planner.figures().share_seen;
  row.is_complete = planner.figures().is_complete();
  return stops;
}

struct Goals {
  ShownSurface shown, any, safe;
};

/// What the stops that the planner may choose from can see.
Goals goals_of(const PlasterTable& table, const pipeline::PlannerConfig& config) {
  const Stops all = test::stops_all_round(config.rot_step_deg, {-30, -20, -10, 0, 10, 20, 30});
  Goals out{shown_by(table, all, test::kShownWell_deg), table.surface(), table.surface()};
  std::vector<std::uint16_t> views(out.any.shown.size(), 0);
  for (const calib::AxisAngles& stop : all) {
    const ShownSurface one = shown_by(table, {stop}, test::kMeasured_deg);
    for (std::size_t n = 0; n < views.size(); ++n) views[n] = static_cast<std::uint16_t>(views[n] + one.shown[n]);
  }
  for (std::size_t n = 0; n < views.size(); ++n) {
    out.any.shown[n] = views[n] > 0 ? 1 : 0;
    out.safe.shown[n] = views[n] >= kSafeViews ? 1 : 0;
  }
  return out;
}

std::vector<Row> study(test::Plaster kind, std::uint64_t seed, const pipeline::PlannerConfig& config) {
  const PlasterTable table(kind, seed);
  const Goals goals = goals_of(table, config);
  const std::vector<std::pair<const char*, std::function<Stops(Row&)>>> plans{
      {"full",
       [](Row&) {
         return test::stops_all_round(15, {-20, 0, 20});
       }},
      {"quick",
       [](Row&) {
         return test::stops_all_round(30, {-15, 15});
       }},
      {"arch",
       [](Row&) {
         return test::stops_all_round(18, {-30, 0, 30});
       }},
      {"planner", [&](Row& row) { return plan(table, config, row); }}};
  std::vector<Row> rows;
  for (const auto& [name, stops_of] : plans) {
    Row row{.model = kind == test::Plaster::kArch ? "arch" : "quadrant", .plan = name, .seed = seed};
    const Stops stops = stops_of(row);
    const ShownSurface measured = shown_by(table, stops, test::kMeasured_deg);
    row.all_mm2 = goals.any.shown_mm2();
    row.shown_share = share_of(shown_by(table, stops, test::kShownWell_deg), goals.shown);
    row.any_share = share_of(measured, goals.any);
    row.measured_share = share_of(measured, goals.safe);
    row.stops = stops.size();
    row.taking_s = seconds(stops, config);
    rows.push_back(row);
  }
  return rows;
}

nlohmann::json to_json(const Row& r) {
  return {{"model", r.model},
          {"plan", r.plan},
          {"seed", r.seed},
          {"all_mm2", r.all_mm2},
          {"shown_share", r.shown_share},
          {"any_share", r.any_share},
          {"measured_share", r.measured_share},
          {"stops", r.stops},
          {"taking_s", r.taking_s},
          {"believed_share", r.believed_share},
          {"is_complete", r.is_complete},
          {"slowest_ms", r.slowest_ms}};
}

void print(const Row& r) {
  std::printf(
      "%-8s %4llu %6.0f mm2  %-8s %3zu stops %6.1f s  shown %.4f  measured %.4f (of any %.4f)  believed %.3f%s  %5.0f "
      "ms\n",
      r.model.c_str(), static_cast<unsigned long long>(r.seed), r.all_mm2, r.plan.c_str(), r.stops, r.taking_s,
      r.shown_share, r.measured_share, r.any_share, r.believed_share, r.is_complete ? "  complete" : "", r.slowest_ms);
  std::fflush(stdout);
}

}  // namespace
}  // namespace enamel::bench

int main(int argc, char** argv) {
  using namespace enamel;
  std::string json;
  std::uint64_t seeds = 6;
  pipeline::PlannerConfig config;
  for (int n = 1; n + 1 < argc; n += 2) {
    const std::string arg = argv[n];
    const char* value = argv[n + 1];
    if (arg == "--json") json = value;
    if (arg == "--seeds") seeds = std::strtoull(value, nullptr, 10);
    if (arg == "--gain") config.min_gain = std::strtod(value, nullptr);
    if (arg == "--cell") config.cell_mm = std::strtod(value, nullptr);
    if (arg == "--most") config.max_stops = std::strtoull(value, nullptr, 10);
  }
  nlohmann::json rows = nlohmann::json::array();
  for (const test::Plaster kind : {test::Plaster::kArch, test::Plaster::kQuadrant}) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      for (const bench::Row& row : bench::study(kind, seed, config)) {
        bench::print(row);
        rows.push_back(bench::to_json(row));
      }
    }
  }
  if (json.empty()) return 0;
  if (const auto written = write_file(json, rows.dump(1) + "\n"); !written) {
    std::fprintf(stderr, "%s\n", written.error().message().c_str());
    return exit_code(written.error().code);
  }
  return 0;
}
