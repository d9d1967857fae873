#include "host/app/demo_desktop.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <utility>
#include <vector>

#include "host/app/child_process.hpp"
#include "host/app/demo_calibration.hpp"
#include "host/app/desktop/desktop_scan.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {
namespace {

namespace fs = std::filesystem;

constexpr auto kPortWithin = std::chrono::seconds(60);  // the scene is built before the controller answers
constexpr auto kSurfaceWithin = std::chrono::seconds(60);

/// mount.json of the simulated table, calibrated as a user would: a coded board at some forty stops. Kept in the cache.
Result<std::string> calibrated_mount(const DesktopDemo& demo, Clock& clock) {
  const std::string mount = demo.cache + "/mount-" + demo.key + ".json";
  std::error_code ec;
  if (fs::exists(mount, ec)) {
    log::info("demo", "calibration of the axes found in the cache: {}", mount);
    return mount;
  }
  log::info("demo", "calibrating the simulated table: a coded board at its stops, then solved");
  const std::string folder = demo.cache + "/board-" + demo.key;
  fs::remove_all(folder, ec);
  auto made = run_or_fail({sibling_program("enamel-twin"), "calibrate", demo.board, "--seed", std::to_string(demo.seed),
                           "--set", "calibration.fringes=false", "--out", folder},
                          {}, clock);
  const std::string partial = mount + ".solving";
  if (made) {
    made = run_or_fail(
        {sibling_program("enamel"), "calibrate", "axes", folder, "--rig", demo.solved_rig, "--out", partial},
        {.stdout_path = demo.run.out + "/mount.txt", .stderr_path = {}}, clock);
  }
  fs::remove_all(folder, ec);
  if (!made) return tl::unexpected<Error>(made.error());
  fs::rename(partial, mount, ec);
  if (ec) return fail(ErrorCode::kFileWrite, mount + ": " + ec.message());
  return mount;
}

Result<void> wait_for(const std::string& path, Nanoseconds within, Clock& clock) {
  const HostTime until = clock.now() + within;
  std::error_code ec;
  while (!fs::exists(fs::symlink_status(path, ec))) {
    if (stop_requested()) return fail(ErrorCode::kCancelled);
    if (clock.now() > until) return fail(ErrorCode::kInternal, path + " did not appear in time");
    clock.sleep_for(std::chrono::milliseconds(50));
  }
  return {};
}

/// On stdout, unless that is for a program.
Result<void> tell_accuracy(const DesktopDemo& demo) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(demo.run.out + "/accuracy.txt"));
  if (!demo.run.json) std::printf("accuracy against the truth, SIMULATED\n%s", text.c_str());
  return {};
}

/// By best fit: the model's frame is the table's, the truth's that of the jaw.
Result<void> compare_with_truth(const DesktopDemo& demo, const std::string& surface, Clock& clock) {
  const std::string& out = demo.run.out;
  return run_or_fail(
      {sibling_program("enamel"), "compare", out + "/mesh.ply", surface, "--align", "best", "--out", out + "/accuracy"},
      {.stdout_path = out + "/accuracy.txt", .stderr_path = {}}, clock);
}

}  // namespace

Result<int> run_desktop_demo(const DesktopDemo& demo) {
  SteadyClock clock;
  const std::string& out = demo.run.out;
  DesktopScan desktop;
  ENAMEL_TRY_ASSIGN(desktop.desktop.mount, calibrated_mount(demo, clock));
  desktop.port = out + "/axes.port";
  desktop.scan.run = demo.run;
  desktop.scan.serial = "SIM-0001";  // of config/rigs/probe.json, the unit that is calibrated
  desktop.scan.link.tag = "enamel-demo-" + std::to_string(::getpid());
  desktop.scan.may_replace_simulated = true;
  desktop.scan.wait_seconds = 60;
  desktop.scan.rig_path = demo.solved_rig;
  desktop.scan.notes = {{"seed", std::to_string(demo.seed)},
                        {"scene", demo.scene},
                        {"pace", "rendered live where the simulated table stands: slower than a real one"}};
  const std::string surface = out + "/truth.ply";
  std::error_code ec;
  fs::remove(surface, ec);
  ENAMEL_TRY_ASSIGN(auto probe,
                    ChildProcess::start({sibling_program("enamel-probe"), "--twin", demo.scene, "--seed",
                                         std::to_string(demo.seed), "--twin-axes", desktop.port, "--twin-surface",
                                         surface, "--serial", desktop.scan.serial, "--dds-tag", desktop.scan.link.tag},
                                        {.stdout_path = out + "/probe.out", .stderr_path = out + "/probe.log"}));
  ENAMEL_TRY(wait_for(desktop.port, kPortWithin, clock));
  ENAMEL_TRY_ASSIGN(const int code, run_desktop_scan(desktop));
  probe.signal(SIGTERM);
  static_cast<void>(probe.wait(clock, kSurfaceWithin));
  if (fs::exists(surface, ec)) {
    ENAMEL_TRY(compare_with_truth(demo, surface, clock));
    ENAMEL_TRY(tell_accuracy(demo));
  }
  return code;
}

}  // namespace enamel::app
