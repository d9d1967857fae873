// How far CLOCK_BOOTTIME is ahead of CLOCK_MONOTONIC.
#pragma once

#include "protocol/base/time.hpp"

namespace enamel {

/// Time that this machine has spent asleep since it started. Thread-safe.
[[nodiscard]] Nanoseconds slept() noexcept;

}  // namespace enamel
