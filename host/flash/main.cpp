// enamel-flash: firmware onto probes over USB.
#include <array>

#include "host/flash/command.hpp"
#include "protocol/base/stdout_check.hpp"
#include "protocol/base/subcommands.hpp"

using namespace enamel::flash_app;

namespace {

constexpr std::array<enamel::Subcommand<Run>, 9> kCommands{{
    {"list", "probes that are connected, and what they run", add_list},
    {"info", "what an image file is; a copy of a probe's calibration", add_info},
    {"flash", "write an image, restart, wait until it is confirmed", add_flash},
    {"recover", "the same as flash, whatever state the probe is in", add_flash},
    {"verify", "does the probe run this image?", add_verify},
    {"rollback", "back to the other slot's firmware", add_rollback},
    {"confirm", "confirm the running firmware", add_confirm},
    {"factory-reset", "erase the settings; calibration and firmware stay", add_factory_reset},
    {"selftest", "let the probe test itself", add_selftest},
}};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Firmware onto probes over USB. Interrupted at any point, the old firmware boots.", "enamel-flash");
  constexpr int kUsage = static_cast<int>(enamel::update::Exit::kUsage);
  const auto command = enamel::parse_subcommand<Run>(app, kCommands, argc, argv, kUsage);
  return enamel::with_stdout_written(command ? static_cast<int>((*command)()) : command.error());
}
