// Chooses what the program runs on.
#pragma once

#include <memory>

#include "firmware/app/options.hpp"
#include "firmware/device/device.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::fw {

/// Errors: those of the twin, of the recording, of the camera; kHal for what this build has not.
[[nodiscard]] Result<std::unique_ptr<Device>> open_device(const ProbeOptions& options, Clock& clock,
                                                          const PartHandler& opened = {});

}  // namespace enamel::fw
