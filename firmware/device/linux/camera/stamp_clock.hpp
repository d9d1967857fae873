// Sensor stamps in the device clock. libcamera says CLOCK_BOOTTIME, V4L2 buffers carry CLOCK_MONOTONIC, pipelines pass
// on either; the two differ by the time that the machine has slept.
#pragma once

#include <cstdint>
#include <cstdlib>

#include "protocol/base/time.hpp"

namespace enamel::fw {

/// A stamp, ns, is taken to be of the clock to whose `now` it is nearer: CLOCK_BOOTTIME is CLOCK_MONOTONIC plus the
/// time that the machine has slept. Pure.
[[nodiscard]] inline DeviceTime monotonic_stamp(std::int64_t stamp, DeviceTime now, Nanoseconds slept) {
  const std::int64_t monotonic = to_ns(now), boottime = monotonic + slept.count();
  return device_time(std::abs(stamp - boottime) < std::abs(stamp - monotonic) ? stamp - slept.count() : stamp);
}

}  // namespace enamel::fw
