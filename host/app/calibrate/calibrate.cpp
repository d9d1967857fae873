// enamel calibrate: from pictures of a target to rig.json, and what a rig.json is worth.
#include <vector>

#include "host/app/calibrate/subcommand.hpp"

namespace enamel::app {

Run add_calibrate(CLI::App& app) {
  app.require_subcommand(1);
  const std::vector<CalibrateCommand> commands{
      add_calibrate_capture(app), add_calibrate_solve(app), add_calibrate_check(app),  add_calibrate_compare(app),
      add_calibrate_show(app),    add_calibrate_list(app),  add_calibrate_revert(app), add_calibrate_join(app),
      add_calibrate_ceramic(app), add_calibrate_axes(app),  add_calibrate_target(app)};
  return [commands]() -> Result<int> {
    for (const CalibrateCommand& command : commands)
      if (command.parser->parsed()) return command.run();
    return 1;
  };
}

}  // namespace enamel::app
