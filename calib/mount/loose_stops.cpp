#include "calib/mount/loose_stops.hpp"

#include <cmath>

namespace enamel::calib {

LooseStops loose_stops(const std::vector<MountStop>& stops) {
  LooseStops out{std::vector<bool>(stops.size(), false), std::vector<bool>(stops.size(), false), false, false};
  constexpr int kSideStops = 3;
  const auto walk = [&](auto command, auto read, std::vector<bool>& loose, bool& is_seen) {
    constexpr double kStill_rad = 1e-6;
    int rising = 0, falling = 0;
    for (std::size_t j = 1; j < stops.size(); ++j) {
      const double step = stops[j].angles.*command - stops[j - 1].angles.*command;
      const bool has_play = std::isnan(stops[j].angles.*read);
      loose[j] = has_play && (step < -kStill_rad || (std::abs(step) <= kStill_rad && loose[j - 1]));
      (loose[j] ? falling : rising) += has_play ? 1 : 0;
    }
    is_seen = rising >= kSideStops && falling >= kSideStops;
    if (!is_seen) loose.assign(stops.size(), false);
  };
  walk(&AxisAngles::rotation_command, &AxisAngles::rotation_read, out.rotation, out.is_rotation_seen);
  walk(&AxisAngles::swing_command, &AxisAngles::swing_read, out.swing, out.is_swing_seen);
  return out;
}

}  // namespace enamel::calib
