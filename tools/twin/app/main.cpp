// enamel-twin: renders what a probe would have recorded, with the truth. SIMULATION ONLY.
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/clock.hpp"
#include "protocol/base/progress.hpp"
#include "protocol/base/stdout_check.hpp"
#include "tools/twin/app/burst_message.hpp"
#include "tools/twin/app/calibration_folder.hpp"
#include "tools/twin/app/preview.hpp"
#include "tools/twin/app/render_sink.hpp"
#include "tools/twin/board/board_source.hpp"
#include "tools/twin/mount/mount_files.hpp"
#include "tools/twin/surface/mesh_file.hpp"
#include "tools/twin/truth_files.hpp"
#include "tools/twin/twin_source.hpp"

namespace {

using enamel::Error;
using enamel::ErrorCode;
using enamel::Result;
namespace twin = enamel::twin;

constexpr std::size_t kMaxPoses = 99;  // two digits

struct Options {
  std::string scene, out;
  std::optional<std::uint64_t> seed;
  std::optional<int> poses;
  std::vector<std::string> overrides;
  std::size_t threads = 0;
  bool truth_maps = false;
};

Result<std::string> png(const std::vector<std::uint8_t>& pixels, int width, int height) {
  std::vector<unsigned char> bytes;
  try {
    cv::Mat image(height, width, CV_8UC1);
    std::copy(pixels.begin(), pixels.end(), image.data);
    cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 3});
  } catch (const cv::Exception& e) {
    return enamel::fail(ErrorCode::kInternal, e.what());
  }
  return std::string(bytes.begin(), bytes.end());
}

Result<void> write_maps(twin::RenderSink& sink, const twin::BurstTruth& truth, int width, int height) {
  char number[32];
  std::snprintf(number, sizeof number, "%06llu", static_cast<unsigned long long>(truth.burst_index));
  const std::string id = number;
  ENAMEL_TRY(sink.file("truth/depth_" + id + ".pfm", twin::pfm(truth.maps.depth, width, height)));
  ENAMEL_TRY_ASSIGN(const std::string lit, png(truth.maps.lit, width, height));
  ENAMEL_TRY(sink.file("truth/lit_" + id + ".png", lit));
  ENAMEL_TRY_ASSIGN(const std::string order, png(truth.maps.order, width, height));
  ENAMEL_TRY(sink.file("truth/order_" + id + ".png", order));
  if (truth.movers.empty()) return {};
  ENAMEL_TRY_ASSIGN(const std::string mover, png(truth.maps.mover, width, height));
  return sink.file("truth/mover_" + id + ".png", mover);
}

Result<twin::SceneConfig> scene_of(const Options& o) {
  std::vector<std::string> overrides = o.overrides;
  if (o.seed) overrides.push_back("seed=" + std::to_string(*o.seed));
  return twin::load_scene(o.scene, overrides);
}

/// Before the first burst.
Result<void> write_mount(twin::RenderSink& sink, const twin::SceneConfig& scene, const enamel::fw::BurstSource& source,
                         int bursts_a_stop) {
  ENAMEL_TRY_ASSIGN(const enamel::calib::Rig rig, enamel::calib::parse_rig(source.rig_text()));
  const twin::MountRun run = twin::drive(scene.mount, scene.seed);
  const twin::AxesTable table{.key = "burst_id", .rows = source.count().value_or(0), .rows_a_stop = bursts_a_stop};
  ENAMEL_TRY(sink.axes(twin::axes_csv(run, scene.mount, scene.seed, table), bursts_a_stop));
  return sink.file("truth/mount_true.json", twin::mount_true_json(run, bursts_a_stop, rig.serial));
}

Result<void> render(const Options& o) {
  const enamel::SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const twin::SceneConfig scene, scene_of(o));
  std::unique_ptr<twin::TwinSource> source;
  {
    enamel::Progress progress(clock, "build the scene", 1);
    ENAMEL_TRY_ASSIGN(source, twin::TwinSource::create(scene));
    progress.advance();
  }
  ENAMEL_TRY_ASSIGN(const auto sink, twin::open_sink(o.out, source->rig_text()));
  const std::uint64_t total = source->count().value_or(0);
  if (scene.path == twin::PathKind::kMount) ENAMEL_TRY(write_mount(*sink, scene, *source, scene.mount.bursts));
  enamel::Progress progress(clock, "render bursts", total);
  std::string poses = twin::poses_header(), movers = twin::movers_header();
  for (std::uint64_t n = 0; n < total; ++n) {
    ENAMEL_TRY_ASSIGN(const auto burst, source->next());
    if (!burst) break;
    ENAMEL_TRY(sink->burst(twin::to_message(*burst, source->rig().crc32)));
    poses += twin::poses_row(source->truth());
    movers += twin::movers_rows(source->truth(), scene.movers);
    if (o.truth_maps) ENAMEL_TRY(write_maps(*sink, source->truth(), burst->width, burst->height));
    progress.advance();
  }
  progress.finish();
  ENAMEL_TRY(sink->file("truth/poses.csv", poses));
  ENAMEL_TRY(sink->file("truth/surface.ply", twin::write_ply(source->surface(), source->seen())));
  if (!scene.movers.empty()) ENAMEL_TRY(sink->file("truth/movers.csv", movers));
  ENAMEL_TRY(sink->file("truth/scene.json", source->scene_json()));
  if (!source->certificate_json().empty()) ENAMEL_TRY(sink->file("artefact.json", source->certificate_json()));
  ENAMEL_TRY(sink->finish());
  std::printf("%llu bursts -> %s\n", static_cast<unsigned long long>(total), o.out.c_str());
  return {};
}

/// The scene's rig before a board; a rig.json stands for a scene of default values.
Result<twin::SceneConfig> calibration_scene(const Options& o) {
  twin::SceneConfig scene;
  if (std::filesystem::path(o.scene).extension() == ".json") {
    if (!o.overrides.empty()) return enamel::fail(ErrorCode::kUsage, "--set needs a scene file, not a rig");
    scene.rig_path = o.scene;
    scene.seed = o.seed.value_or(scene.seed);
  } else {
    ENAMEL_TRY_ASSIGN(scene, scene_of(o));
  }
  scene.calibration.poses = o.poses.value_or(scene.calibration.poses);
  if (scene.path != twin::PathKind::kMount) return scene;
  std::vector<twin::MountStop>& stops = scene.mount.stops;
  if (o.poses && stops.size() > static_cast<std::size_t>(*o.poses)) stops.resize(static_cast<std::size_t>(*o.poses));
  if (stops.size() > kMaxPoses) {
    return enamel::fail(ErrorCode::kConfigValue,
                        o.scene + ": mount has " + std::to_string(stops.size()) +
                            " stops, a calibration folder at most 99 poses: fewer stops or --poses");
  }
  scene.calibration.poses = static_cast<int>(stops.size());
  return scene;
}

Result<void> record_board(const twin::SceneConfig& scene, const std::string& out, const enamel::Clock& clock) {
  ENAMEL_TRY_ASSIGN(const auto source, twin::BoardSource::create(scene));
  ENAMEL_TRY_ASSIGN(const auto sink, twin::open_sink(out, source->rig_text()));
  ENAMEL_TRY_ASSIGN(const enamel::calib::Rig nominal, enamel::calib::parse_rig(source->rig_text()));
  if (scene.path == twin::PathKind::kMount) {
    const int bursts_a_stop = source->stage().patterns().sets() * scene.calibration.sweeps;
    ENAMEL_TRY(write_mount(*sink, scene, *source, bursts_a_stop));
  }
  enamel::Progress progress(clock, "render bursts", source->count().value_or(0));
  for (;;) {
    ENAMEL_TRY_ASSIGN(const auto burst, source->next());
    if (!burst) break;
    ENAMEL_TRY(sink->burst(twin::to_message(*burst, nominal.crc32)));
    progress.advance();
  }
  progress.finish();
  ENAMEL_TRY(sink->file("target.json", twin::target_json(scene.board)));
  ENAMEL_TRY(sink->file("truth/rig.json", source->stage().rig().text));
  return sink->finish();
}

Result<void> calibrate(const Options& o) {
  const enamel::SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const twin::SceneConfig scene, calibration_scene(o));
  if (std::filesystem::path(o.out).extension() == ".mcap") return record_board(scene, o.out, clock);
  enamel::Progress progress(clock, "render poses", static_cast<std::uint64_t>(scene.calibration.poses));
  ENAMEL_TRY(twin::write_calibration_folder(scene, o.out, [&] { progress.advance(); }));
  progress.finish();
  std::printf("%d poses -> %s\n", scene.calibration.poses, o.out.c_str());
  return {};
}

Result<void> preview(const Options& o) {
  ENAMEL_TRY_ASSIGN(const twin::SceneConfig scene, scene_of(o));
  return twin::write_preview(scene, o.out);
}

int report(const Result<void>& result) {
  if (result) return 0;
  std::fputs((result.error().message() + "\n").c_str(), stderr);
  return enamel::exit_code(result.error().code);
}

void add_common(CLI::App* sub, Options& o) {
  sub->add_option("SCENE", o.scene, "scene file (TOML); keys: docs/twin-scene.md. For calibrate also a rig.json")
      ->required();
  sub->add_option("--seed", o.seed, "another patient, path, tremor and noise");
  sub->add_option("--set", o.overrides, "key=value, overrides the scene file");
  sub->add_option("--threads", o.threads, "0: all cores; the result is the same for any number");
}

int run(int argc, char** argv) {
  CLI::App app("enamel-twin: simulated recordings with truth", "enamel-twin");
  app.require_subcommand(1);
  Options o;
  CLI::App* render_cmd = app.add_subcommand("render", "render bursts to a recording (.mcap) or exchange folder");
  add_common(render_cmd, o);
  render_cmd->add_option("--out", o.out, "recording (.mcap) or folder")->required();
  render_cmd->add_flag("--truth-maps", o.truth_maps, "depth, lit and order maps of every burst");
  CLI::App* calibrate_cmd =
      app.add_subcommand("calibrate", "a calibration board before the scene's rig: calibration folder or recording");
  add_common(calibrate_cmd, o);
  calibrate_cmd->add_option("--out", o.out, "calibration folder, or recording (.mcap) of a live calibration")
      ->required();
  calibrate_cmd->add_option("--poses", o.poses, "stands of the board; on a mount its first so many stops")
      ->check(CLI::Range(1, 99));
  CLI::App* preview_cmd = app.add_subcommand("preview", "shaded picture of the scene's body from four sides");
  add_common(preview_cmd, o);
  preview_cmd->add_option("--out", o.out, "PNG file")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 1;
  }
  std::optional<tbb::global_control> limit;
  if (o.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, o.threads);
  if (preview_cmd->parsed()) return report(preview(o));
  if (calibrate_cmd->parsed()) return report(calibrate(o));
  return report(render(o));
}

}  // namespace

int main(int argc, char** argv) {
  // A full file system or a closed pipe shall be an error value, not the end of the program.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  return enamel::with_stdout_written(run(argc, argv));
}
