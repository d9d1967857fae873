// Bursts by the stops at which they were taken.
#pragma once

#include <memory>
#include <vector>

#include "calib/model/mount.hpp"
#include "protocol/types/axes.hpp"
#include "protocol/types/burst.hpp"

namespace enamel::host {

/// At least one burst; head and object stood still meanwhile.
struct StopBursts {
  calib::AxisAngles angles;
  std::vector<std::shared_ptr<const proto::Burst>> bursts;
};

/// Degrees of files as the mount's radians.
[[nodiscard]] calib::AxisAngles angles_of(const proto::AxesReading& reading);

}  // namespace enamel::host
