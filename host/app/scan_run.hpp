// A live scan from finding the probe to the files: what `enamel scan` and `enamel demo` share.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "host/app/out_folder.hpp"
#include "host/app/run_options.hpp"
#include "protocol/base/result.hpp"
#include "protocol/dds/participant.hpp"

namespace enamel::app {

struct ScanRun {
  RunOptions run;
  bool resume = false;                 ///< go on with the session whose recording is in the folder
  bool may_replace_simulated = false;  ///< a recording of a simulated scan in the folder is written over
  std::string serial;                  ///< empty: the only probe there is
  dds::LinkChoice link;
  double seconds = 0;          ///< 0: until the probe's session ends
  double wait_seconds = 15;    ///< for a probe to appear
  bool start_at_once = false;  ///< else the person starts with the space bar
  std::string rig_path;        ///< calibration to measure with; empty: the probe's own
  bool record = true;          ///< capture.mcap in the output folder
  Truth truth;
  std::map<std::string, std::string> notes;  ///< for the report
};

/// No recording is written over: it may be the only copy of a patient's scan. Error: kFileWrite; kFileNotFound where
/// there is none to go on with.
[[nodiscard]] Result<void> keep_recording(const ScanRun& scan, const OutFolder& folder);

/// Returns the exit code: 0, or 4 when the loss equation fails or bursts were lost or incomplete. Errors: those that
/// left nothing to write.
[[nodiscard]] Result<int> run_scan(const ScanRun& scan);

}  // namespace enamel::app
