// From a session to its files, live or played back: the one place that watches it and the one that tells of it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "host/app/calibration.hpp"
#include "host/app/run_options.hpp"
#include "host/session/session.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

struct SessionRun {
  RunOptions run;
  std::string title = "enamel";            ///< of the window
  std::string doing = "scanning";          ///< on the line that shows progress
  std::uint64_t total = 0;                 ///< bursts; 0: not known
  bool window = false;                     ///< show it while it runs
  double seconds = 0;                      ///< end so long after the first burst; 0: with the session
  std::optional<Calibration> calibration;  ///< that measures; empty: the probe's own
  CalibrationLimits limits;                ///< beyond which it is marked
  std::string config_text;                 ///< resolved, TOML
  Truth truth;
  std::map<std::string, std::string> notes;  ///< for the report
};

/// Starts the session, shows it, waits for its end and writes mesh, poses, picture and report into run.run.out, which
/// exists. Returns the exit code: 0, or that of the first of these: the session was broken off, its recording is
/// incomplete, the loss equation fails or bursts were lost. Errors: those that left nothing to write.
[[nodiscard]] Result<int> run_session(host::Session& session, const SessionRun& run, Clock& clock);

}  // namespace enamel::app
