// enamel-flash: firmware onto probes over USB.
#include "host/flash/command.hpp"

using namespace enamel::flash_app;

int main(int argc, char** argv) {
  CLI::App app("Firmware onto probes over USB. Interrupted at any point, the old firmware boots.", "enamel-flash");
  app.require_subcommand(1);
  struct Command {
    CLI::App* app;
    Run run;
  };
  std::vector<Command> commands;
  const auto add = [&](const char* name, const char* what, Run (*setup)(CLI::App&)) {
    CLI::App* sub = app.add_subcommand(name, what);
    commands.push_back({sub, setup(*sub)});
  };
  add("list", "probes that are connected, and what they run", add_list);
  add("info", "what an image file is", add_info);
  add("flash", "write an image, restart, wait until it is confirmed", add_flash);
  CLI::App* recover = app.add_subcommand("recover", "the same as flash, whatever state the probe is in");
  commands.push_back({recover, add_flash(*recover)});
  add("verify", "does the probe run this image?", add_verify);
  add("rollback", "back to the other slot's firmware", add_rollback);
  add("confirm", "confirm the running firmware", add_confirm);
  add("factory-reset", "erase the settings; calibration and firmware stay", add_factory_reset);
  add("selftest", "let the probe test itself", add_selftest);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : static_cast<int>(enamel::update::Exit::kUsage);
  }
  for (const Command& c : commands) {
    if (c.app->parsed()) return static_cast<int>(c.run());
  }
  return static_cast<int>(enamel::update::Exit::kUsage);
}
