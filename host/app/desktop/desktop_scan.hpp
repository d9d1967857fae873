// A live desktop scan from homing the table to the files: what `enamel desktop scan` and `enamel demo --desktop` share.
#pragma once

#include <string>

#include "host/app/desktop/desktop_options.hpp"
#include "host/app/scan_run.hpp"

namespace enamel::app {

struct DesktopScan {
  ScanRun scan;  ///< folder, probe, link, calibration, truth; `start_at_once` and `seconds` are not looked at
  DesktopOptions desktop;
  std::string port;           ///< serial port of the axes
  std::string profile;        ///< of the controller; empty: config/desktop/grbl.toml's values
  std::string plan = "auto";  ///< auto, full, quick, arch, or a file
  int bursts = 2;             ///< at every stop
  double home_within_s = 120;
  bool base = false;  ///< also a closed mesh with a base
};

/// Returns the exit code: as run_session(); 3 where the table was not where it said. Errors: those that left nothing to
/// write: of profile, mount, plan, axes, probe.
[[nodiscard]] Result<int> run_desktop_scan(const DesktopScan& scan);

}  // namespace enamel::app
