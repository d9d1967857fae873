// Data time as the seconds that motion is reckoned in. Private to register.
#pragma once

#include "protocol/base/time.hpp"

namespace enamel::pipeline {

[[nodiscard]] constexpr double seconds(DeviceTime from, DeviceTime to) noexcept {
  return 1e-9 * static_cast<double>((to - from).count());
}

}  // namespace enamel::pipeline
