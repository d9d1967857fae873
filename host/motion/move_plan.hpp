// Which targets are allowed and by which way they are reached. Pure; degrees. Thread-safe: no state.
#pragma once

#include <vector>

#include "host/motion/axes.hpp"

namespace enamel::motion {

/// How one axis stands: where, and whether its last movement was upwards (then its play is on the known side).
struct AxisPlace {
  double at_deg = 0.0;
  bool is_from_below = false;
};

struct AxesPlace {
  AxisPlace rot;
  AxisPlace swing;
};

struct ApproachRule {
  double overshoot_deg = 0.0;  ///< more than any backlash; 0: any direction will do
  double same_deg = 0.0;       ///< angles this close are one: half a motor step
};

/// kAxesRange, with the axis, the angle and the limits.
[[nodiscard]] Result<void> check_target(const AxesAngles& target, const AxesLimits& limits);

/// The targets that leave room for the overshoot below them.
[[nodiscard]] AxesLimits target_limits(const AxesLimits& travel, double overshoot_deg);

/// Points to go to one after another, none when the table stands there already. Every axis ends upwards: one that would
/// come from above, or whose play is on an unknown side, first goes overshoot_deg below its target.
[[nodiscard]] std::vector<AxesAngles> way_to(const AxesAngles& target, const AxesPlace& from, const ApproachRule& rule);

}  // namespace enamel::motion
