// enamel demo: twin -> recording and calibration (cached) -> enamel-probe -> DDS -> this process -> mesh, accuracy,
// picture. With --calibrate the same scan is first shown as the probe left the factory.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "host/app/child_process.hpp"
#include "host/app/command.hpp"
#include "host/app/demo_calibration.hpp"
#include "host/app/demo_desktop.hpp"
#include "host/app/input.hpp"
#include "host/app/out_folder.hpp"
#include "host/app/scan_run.hpp"
#include "host/app/scene_names.hpp"
#include "host/app/screen.hpp"
#include "host/record/burst_stream.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/sha256.hpp"

namespace enamel::app {

namespace {

namespace fs = std::filesystem;

struct Demo {
  ScanRun scan;
  std::string scene;  // a name until run_demo() makes it a path; empty: quadrant, or desktop_arch
  std::string cache;
  std::uint64_t seed = 1;
  bool show_uncalibrated = false;
  bool desktop = false;
};

/// Of a user without a home, or one whose home cannot be written: a folder of his own among the temporary files.
std::string cache_without_home() {
  const char* temporary = std::getenv("TMPDIR");
  return std::string(temporary != nullptr && *temporary != 0 ? temporary : "/tmp") + "/enamel-cache-" +
         std::to_string(::getuid());
}

std::string default_cache() {
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg != 0) return std::string(xdg) + "/enamel";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != 0)
    return std::string(home) + "/.cache/enamel";
  return cache_without_home();
}

Result<std::string> usable_cache(const std::string& wanted) {
  const auto usable = usable_folder(wanted);
  if (usable) return wanted;
  const std::string instead = cache_without_home();
  if (wanted != default_cache() || !usable_folder(instead)) {
    return fail(ErrorCode::kFileWrite, usable.error().detail + "; give another folder with --cache");
  }
  log::warn("demo", "{}: {} is used instead (--cache chooses another)", usable.error().detail, instead);
  return instead;
}

// A recording is used again only for the same scene, seed, rigs and renderer.
Result<std::string> cache_key(const Demo& demo) {
  RollingHash hash;
  ENAMEL_TRY_ASSIGN(const std::string scene, read_file(demo.scene));
  ENAMEL_TRY_ASSIGN(const std::string twin, read_file(sibling_program("enamel-twin")));
  hash.update(scene).update(twin).update(std::to_string(demo.seed));
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(fs::path(demo.scene).parent_path() / "../rigs", ec)) {
    if (const auto rig = read_file(entry.path().string())) hash.update(*rig);
  }
  return hash.hex().substr(0, 16);
}

// Old recordings of other seeds and builds: some hundred megabytes each.
void prune_cache(const std::string& cache, const fs::path& keep) {
  constexpr std::size_t kKept = 3;
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(cache, ec)) {
    if (entry.path().extension() == ".mcap" && entry.path() != keep)
      files.emplace_back(entry.last_write_time(ec), entry.path());
  }
  std::sort(files.begin(), files.end());
  for (std::size_t i = 0; i + kKept - 1 < files.size(); ++i) fs::remove(files[i].second, ec);
}

Result<std::string> recording(const Demo& demo, const std::string& key, Clock& clock) {
  const std::string path = demo.cache + "/demo-" + key + ".mcap";
  std::error_code ec;
  if (fs::exists(path, ec)) {
    log::info("demo", "recording of seed {} found in the cache: {}", demo.seed, path);
    return path;
  }
  prune_cache(demo.cache, path);
  log::info("demo",
            "rendering ahead: two cores render fewer than 30 bursts a second; the probe then plays at the true rate");
  const std::string partial = path + ".rendering.mcap";
  ENAMEL_TRY(run_or_fail(
      {sibling_program("enamel-twin"), "render", demo.scene, "--seed", std::to_string(demo.seed), "--out", partial}, {},
      clock));
  fs::rename(partial, path, ec);
  if (ec) return fail(ErrorCode::kFileWrite, path + ": " + ec.message());
  return path;
}

nlohmann::json accuracy_of(const std::string& folder) {
  const auto text = read_file(folder + "/report.json");
  const auto report = nlohmann::json::parse(text ? *text : "", nullptr, /*allow_exceptions=*/false);
  if (!report.is_object() || !report.contains("accuracy")) return nlohmann::json::object();
  return report["accuracy"];
}

// The recording as measured by what the probe believed of itself before it was calibrated.
Result<void> scan_uncalibrated(const Demo& demo, const std::string& path, const std::string& rig, Clock& clock) {
  log::info("demo", "the same scan with the factory's design values (replay of the recording)");
  const std::string out = demo.scan.run.out + "/uncalibrated";
  ENAMEL_TRY(make_folder(out));
  return run_or_fail({sibling_program("enamel"), "replay", path, "--rig", rig, "--out", out, "--headless"},
                     {.stdout_path = out + "/replay.out", .stderr_path = {}}, clock);
}

// Both accuracies side by side, and in calibrate.json.
Result<void> compare_both(const Demo& demo) {
  const nlohmann::json before = accuracy_of(demo.scan.run.out + "/uncalibrated");
  const nlohmann::json after = accuracy_of(demo.scan.run.out);
  std::FILE* const where = demo.scan.run.json ? stderr : stdout;  // with --json, stdout is the report alone
  std::fprintf(where, "SIMULATED             %14s %14s\n", "design values", "calibrated");
  for (const char* key : {"mean_abs_um", "p95_um", "coverage_pct", "end_error_um"}) {
    const auto text = [&](const nlohmann::json& a) {
      return a.contains(key) && a[key].is_number() ? fmt::format("{:.2f}", a[key].get<double>()) : std::string("none");
    };
    std::fprintf(where, "  %-20s%14s %14s\n", key, text(before).c_str(), text(after).c_str());
  }
  const nlohmann::json both{{"simulated", true}, {"uncalibrated", before}, {"calibrated", after}};
  return write_file(demo.scan.run.out + "/calibrate.json", json_text(both, 1) + "\n");
}

Result<int> run_live(Demo& demo, const std::string& path) {
  demo.scan.link.tag = "enamel-demo-" + std::to_string(::getpid());
  demo.scan.serial = "TWIN-DEMO";
  demo.scan.start_at_once = true;
  demo.scan.may_replace_simulated = true;
  demo.scan.wait_seconds = 30;
  demo.scan.notes = {{"seed", std::to_string(demo.seed)},
                     {"scene", demo.scene},
                     {"pace", "rendered ahead, played by enamel-probe at the true rate"},
                     {"source", path}};
  ENAMEL_TRY_ASSIGN(const auto probe, ChildProcess::start({sibling_program("enamel-probe"), "--play", path, "--serial",
                                                           demo.scan.serial, "--dds-tag", demo.scan.link.tag},
                                                          {.stdout_path = demo.scan.run.out + "/probe.out",
                                                           .stderr_path = demo.scan.run.out + "/probe.log"}));
  return run_scan(demo.scan);
}

Result<int> run_desktop(const Demo& demo, const std::string& key, Clock& clock) {
  ENAMEL_TRY_ASSIGN(const std::string board, scene_file("desktop_board"));
  // The head is the hand-held probe's: its calibration is that of the other demo.
  Demo by_hand = demo;
  ENAMEL_TRY_ASSIGN(by_hand.scene, scene_file("quadrant"));
  ENAMEL_TRY_ASSIGN(const std::string hand_key, cache_key(by_hand));
  ENAMEL_TRY_ASSIGN(const DemoCalibration calibration,
                    demo_calibration(by_hand.scene, demo.seed, demo.cache, hand_key, clock));
  return run_desktop_demo({.run = demo.scan.run,
                           .scene = demo.scene,
                           .board = board,
                           .cache = demo.cache,
                           .key = key,
                           .solved_rig = calibration.solved_rig,
                           .seed = demo.seed});
}

Result<int> run_demo(Demo& demo) {
  SteadyClock clock;
  if (demo.scene.empty()) demo.scene = demo.desktop ? "desktop_arch" : "quadrant";
  ENAMEL_TRY_ASSIGN(demo.scene, scene_file(demo.scene));
  install_stop_signals();
  {
    ENAMEL_TRY_ASSIGN(const OutFolder folder, OutFolder::open(demo.scan.run.out));  // told before anything is rendered
  }
  if (!demo.scan.run.headless) {
    if (const auto display = Screen::try_display(clock); !display) {
      log::warn("demo", "{}: the same without a window (as with --headless)", display.error().detail);
      demo.scan.run.headless = true;
    }
  }
  ENAMEL_TRY_ASSIGN(demo.cache, usable_cache(demo.cache));
  ENAMEL_TRY_ASSIGN(const std::string key, cache_key(demo));
  if (demo.desktop) return run_desktop(demo, key, clock);
  ENAMEL_TRY_ASSIGN(const std::string path, recording(demo, key, clock));
  ENAMEL_TRY_ASSIGN(const DemoCalibration calibration, demo_calibration(demo.scene, demo.seed, demo.cache, key, clock));
  {
    ENAMEL_TRY_ASSIGN(const auto stream, host::open_bursts(path));
    demo.scan.truth = {attached_text(*stream, "truth/surface.ply"), attached_text(*stream, "truth/poses.csv")};
  }
  if (demo.show_uncalibrated) {
    ENAMEL_TRY(scan_uncalibrated(demo, path, calibration.nominal_rig, clock));
  }
  demo.scan.rig_path = calibration.solved_rig;
  ENAMEL_TRY_ASSIGN(const int code, run_live(demo, path));
  if (demo.show_uncalibrated) {
    ENAMEL_TRY(compare_both(demo));
  }
  return code;
}

}  // namespace

Run add_demo(CLI::App& app) {
  auto demo = std::make_shared<Demo>();
  demo->scan.run.out = "out/demo";
  demo->cache = default_cache();
  add_run_options(app, demo->scan.run);
  app.add_option("--out", demo->scan.run.out, "folder for the results")->capture_default_str();
  app.add_option("--seed", demo->seed, "another patient, path, tremor and noise")->capture_default_str();
  app.add_option("--scene", demo->scene, "what the twin renders: a name of config/scenes, or the path of a scene file")
      ->type_name("NAME|PATH")
      ->default_str("quadrant");
  app.add_option("--cache", demo->cache, "where rendered recordings and calibrations are kept")->capture_default_str();
  app.add_flag("--calibrate", demo->show_uncalibrated,
               "scan, calibrate, scan: also measures with the factory's design values and sets both side by side");
  app.add_flag("--desktop", demo->desktop,
               "the desktop scanner instead: a plaster arch on a simulated table, its axes calibrated first")
      ->excludes("--calibrate");
  return [demo]() -> Result<int> { return run_demo(*demo); };
}

}  // namespace enamel::app
