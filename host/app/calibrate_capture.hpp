// enamel calibrate capture: takes the pictures of a calibration from a live probe and guides the person who holds the
// target.
#pragma once

#include "host/app/command.hpp"

namespace enamel::app {

/// Adds the options to `app` ("capture") and returns what to run.
Run add_calibrate_capture(CLI::App& app);

}  // namespace enamel::app
