// enamel desktop: the scanner that stands still above a table with two axes.
#include "host/app/command.hpp"
#include "host/app/desktop/subcommand.hpp"

namespace enamel::app {

Run add_desktop(CLI::App& app) {
  app.require_subcommand(1);
  const std::vector<DesktopCommand> commands{add_desktop_axes(app), add_desktop_scan(app), add_desktop_case(app),
                                             add_desktop_base(app), add_desktop_accuracy(app)};
  return [commands]() -> Result<int> {
    for (const DesktopCommand& command : commands)
      if (command.parser->parsed()) return command.run();
    return exit_code(ErrorCode::kUsage);
  };
}

}  // namespace enamel::app
