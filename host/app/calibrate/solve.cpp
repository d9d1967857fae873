// enamel calibrate solve: from a calibration folder to rig.json.
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/io/rig_writer.hpp"
#include "calib/judge/judgement.hpp"
#include "host/app/calibrate/set.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "host/app/calibrate/verdict.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string folder, out;
  std::string target = "auto";
  std::vector<std::string> hold_out;
  bool json = false;
};

Result<void> write_rig(const Options& o, const calib::CalibFolder& folder, const calib::MeasuredFolder& measured,
                       const calib::Solution& solution) {
  calib::SolvedRig solved{.camera = solution.state.camera,
                          .projector = solution.state.projector,
                          .T_proj_cam = solution.state.T_proj_cam,
                          .parameter_names = {},
                          .covariance = solution.result.covariance,
                          .calibrated_at = calib::capture_time_utc(o.folder),
                          .response = measured.response,
                          .rms_camera_px = solution.result.rms_camera_px,
                          .rms_projector_px = solution.result.rms_projector_px,
                          .poses = static_cast<int>(solution.poses.size())};
  for (const char* name : calib::rig_parameter_names()) solved.parameter_names.emplace_back(name);
  ENAMEL_TRY_ASSIGN(const std::string text, calib::solved_rig_text(folder.nominal, solved));
  return write_file(o.out, text);
}

Result<int> run_solve(const Options& o) {
  static const std::map<std::string, calib::ShapeChoice> kShapes{{"auto", calib::ShapeChoice::kAuto},
                                                                 {"perfect", calib::ShapeChoice::kPerfect},
                                                                 {"solve", calib::ShapeChoice::kSolve}};
  SteadyClock clock;
  const HostTime begin = clock.now();
  const auto seconds = [&] { return std::chrono::duration<double>(clock.now() - begin).count(); };
  ENAMEL_TRY_ASSIGN(const calib::CalibFolder folder, calib::open_calib_folder(o.folder));
  ENAMEL_TRY_ASSIGN(calib::MeasuredFolder measured, measure(folder, clock));
  ENAMEL_TRY_ASSIGN(const auto held_out, take_held_out(o.hold_out, measured));
  const calib::SolveOptions options{.shape = kShapes.at(o.target),
                                    .fringe_period_px = calib::finest_periods_px(folder),
                                    .on_step = [](const std::string& step) { log::info("calibrate", "{}", step); }};
  auto solution = calib::solve(measured.views, folder.target, folder.nominal, options);
  if (!solution) {
    for (const auto& note : measured.rejected) log::warn("calibrate", "pose {}: {}", note.pose, note.reason);
    if (o.json) {
      std::puts(Json{{"verdict", "refused"},
                     {"reasons", {solution.error().detail}},
                     {"poses_used", 0},
                     {"poses_rejected", notes_json(measured.rejected)},
                     {"seconds", seconds()}}
                    .dump(1)
                    .c_str());
    }
    return tl::unexpected<Error>(solution.error());
  }
  solution->rejected.insert(solution->rejected.begin(), measured.rejected.begin(), measured.rejected.end());
  solution->notes.insert(solution->notes.begin(), measured.notes.begin(), measured.notes.end());
  ENAMEL_TRY_ASSIGN(auto planes,
                    check_planes(folder, held_out.empty() ? solution->poses : held_out, solution->state, measured));
  const auto judgement = calib::judge(*solution, std::move(planes), !held_out.empty(), range_of(folder.nominal));
  if (judgement.is_accepted) ENAMEL_TRY(write_rig(o, folder, measured, *solution));
  Json json = verdict_json(*solution, judgement);
  json["seconds"] = seconds();
  show_verdict(json, o.json);
  if (judgement.is_accepted) return 0;
  std::fputs((Error{ErrorCode::kCalibrationRefused, o.out + " is not written"}.message() + "\n").c_str(), stderr);
  return exit_code(ErrorCode::kCalibrationRefused);
}

}  // namespace

CalibrateCommand add_calibrate_solve(CLI::App& app) {
  auto o = std::make_shared<Options>();
  CLI::App* solve = app.add_subcommand("solve", "calibration from a calibration folder");
  solve->add_option("DIR", o->folder, "calibration folder: rig.json, target.json, poses/")->required();
  solve->add_option("--out", o->out, "rig.json to write; nothing is written when the calibration is refused")
      ->required();
  solve->add_option("--target", o->target, "the target's shape: perfect, solve it too, or whichever the data ask for")
      ->check(CLI::IsMember({"auto", "perfect", "solve"}))
      ->capture_default_str();
  solve->add_option("--hold-out", o->hold_out, "poses that only judge")->delimiter(',');
  solve->add_flag("--json", o->json, "one JSON object on stdout");
  return {solve, [o] { return run_solve(*o); }};
}

}  // namespace enamel::app
