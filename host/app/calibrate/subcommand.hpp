// Subcommands of `enamel calibrate`, one file each, after the manner of host/app/command.hpp.
#pragma once

#include "host/app/command.hpp"

namespace enamel::app {

/// A subcommand that added itself to the parser, and what to run when it was chosen.
struct CalibrateCommand {
  CLI::App* parser;
  Run run;
};

CalibrateCommand add_calibrate_axes(CLI::App& app);
CalibrateCommand add_calibrate_capture(CLI::App& app);
CalibrateCommand add_calibrate_ceramic(CLI::App& app);
CalibrateCommand add_calibrate_check(CLI::App& app);
CalibrateCommand add_calibrate_compare(CLI::App& app);
CalibrateCommand add_calibrate_join(CLI::App& app);
CalibrateCommand add_calibrate_list(CLI::App& app);
CalibrateCommand add_calibrate_revert(CLI::App& app);
CalibrateCommand add_calibrate_show(CLI::App& app);
CalibrateCommand add_calibrate_solve(CLI::App& app);
CalibrateCommand add_calibrate_target(CLI::App& app);

}  // namespace enamel::app
