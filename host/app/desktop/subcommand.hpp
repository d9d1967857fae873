// Subcommands of `enamel desktop`, one file each, after the manner of host/app/command.hpp.
#pragma once

#include "host/app/command.hpp"

namespace enamel::app {

/// A subcommand that added itself to the parser, and what to run when it was chosen.
struct DesktopCommand {
  CLI::App* parser;
  Run run;
};

DesktopCommand add_desktop_accuracy(CLI::App& app);
DesktopCommand add_desktop_axes(CLI::App& app);
DesktopCommand add_desktop_base(CLI::App& app);
DesktopCommand add_desktop_case(CLI::App& app);
DesktopCommand add_desktop_scan(CLI::App& app);

}  // namespace enamel::app
