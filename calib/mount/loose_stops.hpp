// Which stops were reached against the drive's approach. Private to calib/mount.
#pragma once

#include <vector>

#include "calib/mount/stops.hpp"

namespace enamel::calib {

/// Which stops were reached against the approach, from the order of commands; only axes without a reading have play.
struct LooseStops {
  std::vector<bool> rotation, swing;
  bool is_rotation_seen = false, is_swing_seen = false;  ///< three stops and more from either side
};
[[nodiscard]] LooseStops loose_stops(const std::vector<MountStop>& stops);

}  // namespace enamel::calib
