// enamel demo --desktop: a plaster arch on a simulated table, from the calibration of the axes to the picture.
#pragma once

#include <cstdint>
#include <string>

#include "host/app/run_options.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

struct DesktopDemo {
  RunOptions run;
  std::string scene;       ///< path; with path.type = mount
  std::string board;       ///< path of the scene with the coded board on the same mount
  std::string cache;       ///< where the calibration of the axes is kept …
  std::string key;         ///< … under this name: changes with scenes, rigs and renderer
  std::string solved_rig;  ///< that measures
  std::uint64_t seed = 1;
};

/// enamel-probe with a table that a GRBL controller on a pseudo-terminal drives, `enamel desktop scan` of it, and the
/// mesh against what the twin knows. Returns the exit code. Errors: kCancelled, kFileWrite, kInternal; those of the
/// scan.
[[nodiscard]] Result<int> run_desktop_demo(const DesktopDemo& demo);

}  // namespace enamel::app
