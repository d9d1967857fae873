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

/// Both readings are of one stop: bursts that follow each other with the same commands; a reading of an encoder may
/// differ by its noise.
[[nodiscard]] bool is_same_stop(const proto::AxesReading& a, const proto::AxesReading& b);

}  // namespace enamel::host
