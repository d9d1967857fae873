// Times of bursts at 30 a second.
#pragma once

#include <cstdint>

#include "protocol/base/time.hpp"

namespace enamel::pipeline {

inline constexpr std::int64_t kPeriodNs = 33'333'333;

inline DeviceTime time_of(int n) { return device_time(1'000'000'000 + n * kPeriodNs); }
inline double seconds_of(int n) { return n * 1e-9 * kPeriodNs; }

}  // namespace enamel::pipeline
