#include "host/motion/move_plan.hpp"

#include <fmt/format.h>

#include <cmath>

namespace enamel::motion {
namespace {

Result<void> check_axis(const char* name, double deg, const AxisLimits& limits) {
  if (!std::isfinite(deg)) return fail(ErrorCode::kAxesRange, fmt::format("{} angle is no number: give degrees", name));
  if (deg >= limits.min_deg && deg <= limits.max_deg) return {};
  return fail(ErrorCode::kAxesRange,
              fmt::format("{} {} deg is outside {}..{} deg: choose an angle inside; the profile's "
                          "min_deg, max_deg and overshoot_deg set these limits",
                          name, deg, limits.min_deg, limits.max_deg));
}

bool needs_detour(double target, const AxisPlace& from, const ApproachRule& rule) {
  if (rule.overshoot_deg <= 0.0) return false;
  const double up = target - from.at_deg;
  if (up < -rule.same_deg) return true;
  // Upwards by less than the play leaves it half taken up, unless it was already.
  return !from.is_from_below && up < rule.overshoot_deg;
}

}  // namespace

const char* state_name(AxesState state) noexcept {
  switch (state) {
    case AxesState::kUnhomed:
      return "unhomed";
    case AxesState::kReady:
      return "ready";
    case AxesState::kMoving:
      return "moving";
    case AxesState::kLost:
      break;
  }
  return "lost";
}

Result<void> check_target(const AxesAngles& target, const AxesLimits& limits) {
  ENAMEL_TRY(check_axis("rotation", target.rot_deg, limits.rot));
  return check_axis("swing", target.swing_deg, limits.swing);
}

AxesLimits target_limits(const AxesLimits& travel, double overshoot_deg) {
  return {{travel.rot.min_deg + overshoot_deg, travel.rot.max_deg},
          {travel.swing.min_deg + overshoot_deg, travel.swing.max_deg}};
}

std::vector<AxesAngles> way_to(const AxesAngles& target, const AxesPlace& from, const ApproachRule& rule) {
  const bool rot_detour = needs_detour(target.rot_deg, from.rot, rule);
  const bool swing_detour = needs_detour(target.swing_deg, from.swing, rule);
  std::vector<AxesAngles> way;
  if (rot_detour || swing_detour) {
    way.push_back({rot_detour ? target.rot_deg - rule.overshoot_deg : from.rot.at_deg,
                   swing_detour ? target.swing_deg - rule.overshoot_deg : from.swing.at_deg});
  }
  const bool is_there = std::abs(target.rot_deg - from.rot.at_deg) <= rule.same_deg &&
                        std::abs(target.swing_deg - from.swing.at_deg) <= rule.same_deg;
  if (!way.empty() || !is_there) way.push_back(target);
  return way;
}

}  // namespace enamel::motion
