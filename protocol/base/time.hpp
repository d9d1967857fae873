// Time points. The probe's clock and the host's clock are different types; only a ClockMap converts between them.
#pragma once

#include <chrono>
#include <cstdint>

namespace enamel {

/// Tag clocks: no now(), time comes from an injected Clock or from data.
struct DeviceClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<DeviceClock>;
  static constexpr bool is_steady = true;  // NOLINT(readability-identifier-naming): the standard's name
};
struct HostClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<HostClock>;
  static constexpr bool is_steady = true;  // NOLINT(readability-identifier-naming): the standard's name
};

using DeviceTime = DeviceClock::time_point;  ///< probe's monotonic clock, ns
using HostTime = HostClock::time_point;      ///< host's monotonic clock, ns
using Nanoseconds = std::chrono::nanoseconds;

[[nodiscard]] constexpr std::int64_t to_ns(DeviceTime t) noexcept { return t.time_since_epoch().count(); }
[[nodiscard]] constexpr std::int64_t to_ns(HostTime t) noexcept { return t.time_since_epoch().count(); }
[[nodiscard]] constexpr DeviceTime device_time(std::int64_t ns) noexcept { return DeviceTime{Nanoseconds{ns}}; }
[[nodiscard]] constexpr HostTime host_time(std::int64_t ns) noexcept { return HostTime{Nanoseconds{ns}}; }

}  // namespace enamel
