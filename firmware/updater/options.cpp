#include "firmware/updater/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <map>

namespace enamel::fw {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 stopped by a signal, 10 restart wanted, 11 restart into recovery wanted, 12 the firmware on trial "
    "failed "
    "its self-test: restart; 1 usage, 2 files, 3 device. Whoever supervises starts it again after 10, 11 (with "
    "--recovery) "
    "and 12; on a probe that is a reboot.";

}  // namespace

image::Serial serial_bytes(const std::string& text) {
  image::Serial serial{};
  std::copy_n(text.begin(), std::min(text.size(), serial.size()), serial.begin());
  return serial;
}

Result<std::optional<UpdaterOptions>> parse_updater_options(int argc, const char* const* argv) {
  UpdaterOptions o;
  std::string slot;
  CLI::App app("enamel-updated: the probe's half of an update over USB. Serves DFU on a FunctionFS mount.",
               "enamel-updated");
  app.add_option("--flash", o.flash, "block device or file with both slots (docs/firmware-image.md, flash map)")
      ->required();
  app.add_option("--functionfs", o.functionfs, "where functionfs is mounted")->required();
  app.add_option("--gadget", o.gadget,
                 "folder of the gadget in configfs: gets ids, version and serial, and is connected");
  app.add_option("--serial", o.serial, "serial number, at most 16 bytes")->required();
  app.add_option("--hw-rev", o.hw_rev, "hardware revision")->required();
  app.add_flag("--development", o.development, "the development fuse is set: development keys are believed");
  app.add_flag("--factory", o.in_factory, "the unit has not been delivered: images for the factory only are accepted");
  app.add_option("--slot", slot, "the slot that the bootloader started; without it the boot policy decides here")
      ->check(CLI::IsMember({"A", "B"}));
  app.add_flag("--recovery", o.recovery, "nothing of the slots runs: accept an image and nothing else");
  app.add_option("--self-test", o.self_test, "shell command; exit code 0: camera, projector and link are well");
  app.add_option("--battery", o.battery, "folder in /sys/class/power_supply; without it the probe lives on USB power");
  app.add_option("--scan-lock", o.scan_lock,
                 "file that enamel-probe locks (flock) while it scans, and this while it updates");
  app.add_option("--calibration", o.calibration,
                 "rig.json, for hosts that keep a copy (`enamel-flash info --save-calib`)");
  app.add_option("--counter-after", o.counter_after_s, "s of confirmed firmware before the minimum counter rises")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.footer(kExitCodes);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return std::optional<UpdaterOptions>{};
  } catch (const CLI::ParseError& e) {
    return fail(ErrorCode::kUsage, e.what());
  }
  if (o.serial.empty() || o.serial.size() > image::Serial().size()) {
    return fail(ErrorCode::kUsage, "--serial: 1 to 16 bytes");
  }
  if (!slot.empty() && o.recovery) return fail(ErrorCode::kUsage, "--slot and --recovery exclude each other");
  if (!slot.empty()) o.slot = slot == "A" ? 0 : 1;
  return std::optional(o);
}

}  // namespace enamel::fw
