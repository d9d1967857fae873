#include "host/desktop/stop_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/motion/move_plan.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/plain_text.hpp"

namespace enamel::host {
namespace {

constexpr double kTurn_deg = 360;
constexpr std::string_view kPlanHeader = "rot_deg,swing_deg";

/// Rotations from 0 up to the whole turn, swings up and down by turns: after each the table has turned one step or the
/// cradle has swung one, never both far.
StopPlan boustrophedon(double rot_step_deg, std::vector<double> swings_deg) {
  StopPlan plan;
  for (double rot = 0; rot < kTurn_deg; rot += rot_step_deg) {
    for (const double swing : swings_deg) plan.push_back({rot, swing});
    std::reverse(swings_deg.begin(), swings_deg.end());
  }
  return plan;
}

/// Empty when good, else what is wrong.
std::string read_stop(std::string_view line, motion::AxesAngles& stop) {
  const auto fields = table_fields(line);
  if (fields.size() != 2) return fmt::format("{} fields, expected 2", fields.size());
  if (!read_number(fields[0], stop.rot_deg) || !std::isfinite(stop.rot_deg)) return "rot_deg is no number";
  if (!read_number(fields[1], stop.swing_deg) || !std::isfinite(stop.swing_deg)) return "swing_deg is no number";
  return {};
}

}  // namespace

Result<StopPlan> named_plan(std::string_view name) {
  if (name == "full") return boustrophedon(15, {-20, 0, 20});
  if (name == "quick") return boustrophedon(30, {-15, 15});
  // What two swings show least of is what both flanks hide: the cradle's ends show a third more than 20 degrees do.
  if (name == "arch") return boustrophedon(18, {-30, 0, 30});
  return fail(ErrorCode::kStopPlan, fmt::format("no plan is named '{}'; there are {}", name, kPlanNames));
}

Result<void> check_plan(const StopPlan& plan, const motion::AxesLimits& limits) {
  if (plan.empty()) return fail(ErrorCode::kStopPlan, "the plan holds no stop");
  for (std::size_t n = 0; n < plan.size(); ++n) {
    if (const auto inside = motion::check_target(plan[n], limits); !inside)
      return fail(inside.error().code, fmt::format("stop {} of {}: {}", n + 1, plan.size(), inside.error().detail));
  }
  return {};
}

Result<StopPlan> parse_plan(std::string_view text, const std::string& path, const motion::AxesLimits& limits) {
  StopPlan plan;
  const std::string table = plain_table(text);
  std::string_view rest = table;
  for (int number = 1; !rest.empty(); ++number) {
    const std::string_view line = cut(rest, '\n');
    const auto at_line = [&](const std::string& what) { return fmt::format("{}:{}: {}", path, number, what); };
    if (number == 1) {
      if (line != kPlanHeader)
        return fail(ErrorCode::kStopPlan, at_line(fmt::format("first line must be {}", kPlanHeader)));
      continue;
    }
    motion::AxesAngles stop;
    if (const std::string problem = read_stop(line, stop); !problem.empty())
      return fail(ErrorCode::kStopPlan, at_line(problem));
    if (const auto inside = motion::check_target(stop, limits); !inside)
      return fail(inside.error().code, at_line(inside.error().detail));
    plan.push_back(stop);
  }
  if (plan.empty()) return fail(ErrorCode::kStopPlan, path + ": the plan holds no stop");
  return plan;
}

Result<StopPlan> read_plan(const std::string& path, const motion::AxesLimits& limits) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  return parse_plan(text, path, limits);
}

pipeline::PlannerConfig within(pipeline::PlannerConfig config, const motion::AxesLimits& limits) {
  config.rot_from_deg = std::max(config.rot_from_deg, limits.rot.min_deg);
  config.rot_to_deg = std::min(config.rot_to_deg, limits.rot.max_deg);
  config.swing_from_deg = std::max(config.swing_from_deg, limits.swing.min_deg);
  config.swing_to_deg = std::min(config.swing_to_deg, limits.swing.max_deg);
  return config;
}

std::optional<motion::AxesAngles> FixedPlan::next(const DesktopModel&) {
  has_ended_ = given_ == plan_.size();
  if (has_ended_) return std::nullopt;
  return plan_[given_++];
}

PlanOutcome FixedPlan::outcome() const {
  return {.is_automatic = false, .ended = has_ended_ ? "planned" : "stopped", .is_complete = has_ended_};
}

PlanOutcome PlannedStops::outcome() const {
  const pipeline::PlanFigures figures = planner_.figures();
  PlanOutcome out{.is_automatic = true, .is_complete = figures.is_complete(), .share_seen = figures.share_seen};
  switch (figures.end) {
    case pipeline::PlanEnd::kGoesOn:
      break;
    case pipeline::PlanEnd::kComplete:
      out.ended = "complete";
      break;
    case pipeline::PlanEnd::kMaxStops:
      out.ended = "max_stops";
      break;
    case pipeline::PlanEnd::kNothingSeen:
      out.ended = "nothing_seen";
      break;
  }
  return out;
}

std::optional<motion::AxesAngles> PlannedStops::next(const DesktopModel& so_far) {
  for (; told_ < so_far.stops().size(); ++told_) {
    planner_.seen(so_far.stops()[told_].angles, so_far.patch_of(told_));
  }
  const auto angles = planner_.next();
  if (!angles) return std::nullopt;
  return motion::AxesAngles{angles->rotation() * calib::kDegreesPerRad, angles->swing() * calib::kDegreesPerRad};
}

}  // namespace enamel::host
