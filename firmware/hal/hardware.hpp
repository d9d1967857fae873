// Everything a probe is made of, as the rest of the firmware sees it.
#pragma once

#include "firmware/hal/camera.hpp"
#include "firmware/hal/edges.hpp"
#include "firmware/hal/light.hpp"
#include "firmware/hal/projector.hpp"
#include "firmware/hal/thermal.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::fw {

struct Hardware {
  Camera& camera;
  Projector& projector;
  EdgeStream& edges;
  Light& light;
  Thermal& thermal;
};

/// The device clock is the monotonic clock of the machine that the firmware runs on.
[[nodiscard]] inline DeviceTime device_now(const Clock& clock) { return device_time(to_ns(clock.now())); }

}  // namespace enamel::fw
