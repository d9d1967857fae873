#include "firmware/app/options.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>

namespace enamel::fw {
namespace {

void add_sources(CLI::App& app, ProbeOptions& o) {
  auto* source = app.add_option_group("source", "Where light comes from (one of)");
  source->add_option("--twin", o.twin_scene, "virtual mouth: SCENE.toml")->type_name("SCENE");
  source->add_option("--play", o.capture, "recording, played once at recorded speed; then the session ends")
      ->type_name("CAPTURE");
  source
      ->add_option("--camera", o.camera, "real camera by id or model; 'list' prints those there are, with their modes")
      ->type_name("ID|list");
  source
      ->add_option("--profile", o.profile, "this board: camera, projector, lines and sensors as PROFILE.toml has them")
      ->type_name("PROFILE");
  source->add_flag("--self-test", o.self_test,
                   "no light: asks the enamel-probe that runs here to test itself; exit code 0 when it passed");
  source->require_option(1);
}

void add_axes(CLI::App& app, ProbeOptions& o) {
  app.add_option(
         "--twin-axes", o.twin_axes,
         "with --twin of a desktop scene: make a serial port of this name, on which a simulated GRBL controller "
         "drives the table")
      ->type_name("PORT");
  app.add_option("--twin-axes-fault", o.twin_axes_fault,
                 "with --twin-axes: lose-step, hard-limit, restart, power-off, unplug or hang in the N-th movement")
      ->type_name("FAULT@N");
  app.add_option("--twin-surface", o.twin_surface,
                 "with --twin-axes: write at the end the surface, PLY, and in how many bursts each vertex was seen");
  app.add_option("--twin-truth", o.twin_truth, "with --twin-axes: write where the table stood in every burst")
      ->type_name("FILE.csv");
}

/// What goes with what.
Result<void> check_together(const ProbeOptions& o) {
  if (o.serial.size() > 32) return fail(ErrorCode::kUsage, "--serial: at most 32 bytes");
  if (o.seed && o.twin_scene.empty()) return fail(ErrorCode::kUsage, "--seed goes with --twin");
  if (!o.twin_axes.empty() && o.twin_scene.empty()) return fail(ErrorCode::kUsage, "--twin-axes goes with --twin");
  if (o.twin_axes.empty() && !(o.twin_axes_fault.empty() && o.twin_truth.empty() && o.twin_surface.empty())) {
    return fail(ErrorCode::kUsage, "--twin-axes-fault, --twin-truth and --twin-surface go with --twin-axes");
  }
  if (o.loops != 1 && o.capture.empty()) return fail(ErrorCode::kUsage, "--loops goes with --play");
  if (!o.picture.empty() && !o.check) return fail(ErrorCode::kUsage, "--picture goes with --check");
  if (o.dark && o.profile.empty()) return fail(ErrorCode::kUsage, "--dark goes with --profile");
  if (o.check && (o.self_test || o.dark || !o.camera.empty())) {
    return fail(ErrorCode::kUsage, "--check goes with --profile, --twin or --play");
  }
  if (o.serial.empty() && !o.profile.empty() && !o.check && !o.dark) {
    return fail(ErrorCode::kUsage, "--profile: give the probe's serial number with --serial");
  }
  return {};
}

}  // namespace

Result<std::optional<ProbeOptions>> parse_options(int argc, const char* const* argv) {
  ProbeOptions o;
  dds::LinkChoice link;
  CLI::App app(
      "enamel-probe: the acquisition process of the probe. Waits for a host, scans when told to, publishes bursts.",
      "enamel-probe");
  app.footer("enamel-probe projector --help: the projector's controller by itself");
  add_sources(app, o);
  add_axes(app, o);
  app.add_flag("--check", o.check, "prove it part by part with twenty bursts, then end; exit code 0 when all is good");
  app.add_option("--picture", o.picture, "with --check: write a burst's four frames, side by side")
      ->type_name("FILE.pgm");
  app.add_flag("--dark", o.dark, "with --profile: switch light and heater off, whoever left them on, then end");
  app.add_option("--seed", o.seed, "with --twin: another patient, path, tremor and noise");
  app.add_option("--serial", o.serial, "serial number; default: sim-<process id>");
  app.add_option(
         "--link", link.link,
         "network to the host: loopback, usb, wifi, or FILE.toml (default: loopback, or what CYCLONEDDS_URI says)")
      ->type_name("NAME|FILE");
  app.add_option("--peer", link.peers, "with --link: address of the host, where it does not know the probe's")
      ->type_name("ADDRESS");
  app.add_option("--dds-tag", link.tag, "only hosts with the same tag see this probe")->capture_default_str();
  app.add_option("--speed", o.speed, "time scale: 0.5 plays everything half as fast, exposures included")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  app.add_option("--loops", o.loops, "with --play: rounds")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--seconds", o.seconds, "end after so many seconds")->check(CLI::NonNegativeNumber);
  app.add_option("--scan-lock", o.scan_lock,
                 "file shared with enamel-updated: no update during a scan, no scan during one")
      ->type_name("FILE");
  app.add_flag("--exit-after-session", o.exit_after_session, "end when a host has closed its session (as --play does)");
  app.add_flag("--json", o.json, "print the counters on stdout at the end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return std::optional<ProbeOptions>{};
  } catch (const CLI::ParseError& e) {
    return fail(ErrorCode::kUsage, e.what());
  }
  ENAMEL_TRY_ASSIGN(o.link, dds::participant_options(link, dds::LinkEnd::kProbe));
  ENAMEL_TRY(check_together(o));
  if (o.serial.empty() && !o.self_test) o.serial = fmt::format("sim-{}", getpid());
  if (!o.capture.empty()) o.exit_after_session = true;
  return std::optional(o);
}

}  // namespace enamel::fw
