// enamel calibrate: from pictures of a target to rig.json.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/io/calib_folder.hpp"
#include "calib/io/rig_writer.hpp"
#include "calib/solve/measure.hpp"
#include "calib/solve/solve.hpp"
#include "host/app/command.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/progress.hpp"

namespace enamel::app {

namespace {

struct Options {
  std::string folder, out;
  std::string target = "auto";
  bool json = false;
};

struct Measured {
  std::vector<calib::PoseView> views;
  std::vector<calib::PoseNote> rejected;
};

Result<Measured> measure(const calib::CalibFolder& folder, const Clock& clock) {
  Measured out;
  Progress progress(clock, "measuring poses", folder.poses.size());
  std::optional<calib::PixelNoise> noise = folder.noise;
  for (const std::string& pose : folder.poses) {
    const auto frames = calib::load_pose(folder, pose);
    if (frames && !noise) {
      noise = calib::estimate_noise(*frames);
      log::info("calibrate", "rig.json states no noise: estimated from pose {}", pose);
    }
    auto view = !frames ? Result<calib::PoseView>(tl::unexpected<Error>(frames.error()))
                        : calib::measure_pose(*frames, folder.target, *noise, folder.saturation_dn,
                                              {folder.nominal.projector.width, folder.nominal.projector.height});
    if (view) {
      out.views.push_back(std::move(*view));
    } else {
      out.rejected.push_back({pose, std::string(describe(view.error().code).text) + ": " + view.error().detail});
    }
    progress.advance();
  }
  return out;
}

nlohmann::ordered_json verdict_json(const calib::Solution& s, double seconds) {
  nlohmann::ordered_json json{{"verdict", "accepted"}, {"reasons", nlohmann::json::array()}};
  json["rms_camera_px"] = s.result.rms_camera_px;
  json["rms_projector_px"] = s.result.rms_projector_px;
  json["poses_used"] = s.poses.size();
  json["poses_rejected"] = nlohmann::json::array();
  for (const auto& note : s.rejected) json["poses_rejected"].push_back({{"pose", note.pose}, {"reason", note.reason}});
  json["notes"] = s.notes;
  json["seconds"] = seconds;
  return json;
}

Result<int> run_solve(const Options& o) {
  SteadyClock clock;
  const HostTime begin = clock.now();
  ENAMEL_TRY_ASSIGN(const calib::CalibFolder folder, calib::open_calib_folder(o.folder));
  ENAMEL_TRY_ASSIGN(Measured measured, measure(folder, clock));
  for (const auto& note : measured.rejected) log::warn("calibrate", "pose {} left out: {}", note.pose, note.reason);
  static const std::map<std::string, calib::ShapeChoice> kShapes{{"auto", calib::ShapeChoice::kAuto},
                                                                 {"perfect", calib::ShapeChoice::kPerfect},
                                                                 {"solve", calib::ShapeChoice::kSolve}};
  calib::SolveOptions options{
      .shape = kShapes.at(o.target),
      .fringe_period_px = {static_cast<double>(folder.nominal.projector.width) / folder.cycles_u.back(),
                           static_cast<double>(folder.nominal.projector.height) / folder.cycles_v.back()},
      .on_step = [](const std::string& step) { log::info("calibrate", "{}", step); }};
  ENAMEL_TRY_ASSIGN(calib::Solution solution,
                    calib::solve(std::move(measured.views), folder.target, folder.nominal, options));
  solution.rejected.insert(solution.rejected.begin(), measured.rejected.begin(), measured.rejected.end());
  calib::SolvedRig solved{.camera = solution.state.camera,
                          .projector = solution.state.projector,
                          .T_proj_cam = solution.state.T_proj_cam,
                          .parameter_names = {},
                          .covariance = solution.result.covariance,
                          .calibrated_at = calib::capture_time_utc(o.folder),
                          .rms_camera_px = solution.result.rms_camera_px,
                          .rms_projector_px = solution.result.rms_projector_px,
                          .poses = static_cast<int>(solution.poses.size())};
  for (const char* name : calib::rig_parameter_names()) solved.parameter_names.emplace_back(name);
  ENAMEL_TRY_ASSIGN(const std::string text, calib::solved_rig_text(folder.nominal, solved));
  ENAMEL_TRY(write_file(o.out, text));
  const double seconds = std::chrono::duration<double>(clock.now() - begin).count();
  std::puts(verdict_json(solution, seconds).dump(1).c_str());
  return 0;
}

}  // namespace

Run add_calibrate(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.require_subcommand(1);
  CLI::App* solve = app.add_subcommand("solve", "calibration from a calibration folder");
  solve->add_option("DIR", o->folder, "calibration folder: rig.json, target.json, poses/")->required();
  solve->add_option("--out", o->out, "rig.json to write")->required();
  solve->add_option("--target", o->target, "the target's shape: perfect, solve it too, or whichever the data ask for")
      ->check(CLI::IsMember({"auto", "perfect", "solve"}))
      ->capture_default_str();
  solve->add_flag("--json", o->json, "one JSON object on stdout");
  return [o]() -> Result<int> { return run_solve(*o); };
}

}  // namespace enamel::app
