// Subcommands of `enamel`. Each is a function that adds itself to the parser and returns what to run when it was
// chosen.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "protocol/base/result.hpp"

namespace enamel::app {

/// Runs a chosen subcommand. The value is the exit code of a run that ended without error (0, 1, 4 or 6).
using Run = std::function<Result<int>()>;

Run add_calibrate(CLI::App& app);
Run add_capture(CLI::App& app);
Run add_compare(CLI::App& app);
Run add_config(CLI::App& app);
Run add_decode(CLI::App& app);
Run add_demo(CLI::App& app);
Run add_desktop(CLI::App& app);
Run add_doctor(CLI::App& app);
Run add_export(CLI::App& app);
Run add_inspect(CLI::App& app);
Run add_patterns(CLI::App& app);
Run add_replay(CLI::App& app);
Run add_scan(CLI::App& app);

}  // namespace enamel::app
