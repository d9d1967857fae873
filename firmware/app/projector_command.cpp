#include "firmware/app/projector_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/model/rig.hpp"
#include "firmware/device/linux/dlpc347x/dlpc347x.hpp"
#include "firmware/device/linux/dlpc347x/pattern_block.hpp"
#include "firmware/device/linux/dlpc350/dlpc350.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::fw {
namespace {

struct ProjectorOptions {
  std::string bus = "/dev/i2c-1", hid, dmd = "DLP2010", rig, out;
  int image = 0;
  std::uint16_t led = 100;
  double seconds = 5;
  bool json = false;
};

struct OpenProjector {
  std::unique_ptr<I2cBus> bus;
  std::unique_ptr<HidPort> hid;
  std::unique_ptr<ProjectorController> controller;
  PatternTiming timing;
};

Result<OpenProjector> open_projector(const ProjectorOptions& o, Clock& clock) {
  OpenProjector opened;
  if (o.hid.empty()) {
    ENAMEL_TRY_ASSIGN(opened.bus, open_i2c(o.bus, kDlpcAddress));
    ENAMEL_TRY_ASSIGN(const Dlpc347x controller, Dlpc347x::open(*opened.bus, clock, {}));
    opened.controller = std::make_unique<Dlpc347x>(controller);
  } else {
    ENAMEL_TRY_ASSIGN(opened.hid, open_hidraw(o.hid));
    ENAMEL_TRY_ASSIGN(const Dlpc350 controller,
                      Dlpc350::open(*opened.hid, clock, kDlpc350Limits, static_cast<std::uint8_t>(o.image)));
    opened.controller = std::make_unique<Dlpc350>(controller);
    opened.timing = kDlpc350Timing;
  }
  return opened;
}

Result<int> info(const ProjectorOptions& o) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(auto projector, open_projector(o, clock));
  ENAMEL_TRY_ASSIGN(const ControllerStatus s, projector.controller->status());
  const nlohmann::ordered_json out{{"type", s.type},
                                   {"version", s.version},
                                   {"celsius", s.celsius ? nlohmann::ordered_json(*s.celsius) : nullptr},
                                   {"system_error", s.system_error},
                                   {"sequence_error", s.sequence_error},
                                   {"sequence_abort", s.sequence_abort},
                                   {"watchdog", s.watchdog},
                                   {"led_errors", s.led_errors}};
  if (o.json) {
    std::cout << json_text(out) << std::endl;
  } else {
    for (const auto& [key, value] : out.items()) std::cout << key << ": " << value << "\n";
  }
  return 0;
}

Result<int> load(const ProjectorOptions& o) {
  if (!o.hid.empty()) {
    return fail(
        ErrorCode::kUsage,
        "a DLPC350 takes no patterns over --hid: its images are part of its firmware, which TI's program writes");
  }
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, calib::load_rig(o.rig));
  const Dmd& dmd = o.dmd == kDlp2010.name ? kDlp2010 : kDlp3010;
  ENAMEL_TRY_ASSIGN(const auto block, pattern_block(rig, dmd, {}, kBlueLed));
  if (!o.out.empty()) {
    ENAMEL_TRY(write_file(o.out, std::string(block.begin(), block.end())));
    std::cout << o.out << ": " << block.size() << " bytes" << std::endl;
    return 0;
  }
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const auto bus, open_i2c(o.bus, kDlpcAddress));
  ENAMEL_TRY_ASSIGN(Dlpc347x controller, Dlpc347x::open(*bus, clock, {}));
  ENAMEL_TRY(controller.validate({}));
  ENAMEL_TRY(controller.load(block));
  std::cout << block.size() << " bytes of patterns written and read back" << std::endl;
  return 0;
}

std::string told(const PatternStatus& now, int most_shown) {
  if (!now.shown)
    return now.ready ? "the sequence runs; it does not tell whether triggers come in" : "the sequence stopped";
  return most_shown > 0 ? "patterns are shown when triggered" : "no pattern was shown: no trigger came in";
}

Result<void> show(const OpenProjector& projector, const ProjectorOptions& o, Clock& clock,
                  const std::atomic<bool>& stop) {
  ProjectorController& controller = *projector.controller;
  ENAMEL_TRY(controller.arm(projector.timing));
  ENAMEL_TRY(controller.set_led(o.led));
  ENAMEL_TRY(controller.start());
  const HostTime end = clock.now() + Nanoseconds{static_cast<std::int64_t>(o.seconds * 1e9)};
  PatternStatus now;
  int shown = 0;
  while (clock.now() < end && !stop.load(std::memory_order_acquire)) {
    clock.sleep_for(Nanoseconds{50'000'000});
    ENAMEL_TRY_ASSIGN(now, controller.pattern_status());
    shown = std::max(shown, now.shown.value_or(0));
  }
  std::cout << told(now, shown) << std::endl;
  return controller.stop();
}

Result<int> test(const ProjectorOptions& o, const std::atomic<bool>& stop) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(auto projector, open_projector(o, clock));
  const auto shown = show(projector, o, clock, stop);
  projector.controller->blank();
  ENAMEL_TRY(shown);
  return 0;
}

}  // namespace

Result<int> run_projector(int argc, const char* const* argv, const std::atomic<bool>& stop) {
  ProjectorOptions o;
  CLI::App app("The projector of this probe: DLPC3470, 3478, 3479 over I2C, DLPC350 over USB.",
               "enamel-probe projector");
  app.require_subcommand(1);
  CLI::App* const say = app.add_subcommand("info", "type, software, temperature, faults; the light stays off");
  CLI::App* const write = app.add_subcommand("load", "write the patterns of a rig into its flash and read them back");
  CLI::App* const light = app.add_subcommand("test", "show the patterns for a while, then dark");
  for (CLI::App* command : {say, write, light}) {
    CLI::Option* const bus = command->add_option("--bus", o.bus, "I2C bus")->type_name("DEVICE")->capture_default_str();
    command->add_option("--hid", o.hid, "a DLPC350 instead: /dev/hidrawN, or any")->type_name("DEVICE")->excludes(bus);
  }
  say->add_flag("--json", o.json, "one JSON object on stdout");
  write->add_option("RIG", o.rig, "rig.json, which states the pattern set")->required();
  write->add_option("--dmd", o.dmd, "mirror array")
      ->check(CLI::IsMember({"DLP2010", "DLP3010"}))
      ->capture_default_str();
  write->add_option("--out", o.out, "write the block into a file instead; no projector is needed")->type_name("FILE");
  light->add_option("--led", o.led, "current of the blue LED, in the controller's code")
      ->check(CLI::Range(1, int{ProjectorLimits{}.max_led_code}))
      ->capture_default_str();
  light->add_option("--image", o.image, "of a DLPC350: first of the two flash images with the patterns")
      ->check(CLI::Range(0, int{kDlpc350LastImage}))
      ->capture_default_str();
  light->add_option("--seconds", o.seconds, "how long")->check(CLI::Range(0.1, 600.0))->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help("", app.get_subcommands().empty() ? CLI::AppFormatMode::All : CLI::AppFormatMode::Normal);
    return 0;
  } catch (const CLI::ParseError& e) {
    return fail(ErrorCode::kUsage, e.what());
  }
  if (say->parsed()) return info(o);
  return write->parsed() ? load(o) : test(o, stop);
}

}  // namespace enamel::fw
