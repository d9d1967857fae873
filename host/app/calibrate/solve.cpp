// enamel calibrate solve: from a calibration folder to rig.json.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "calib/io/rig_store.hpp"
#include "calib/judge/judgement.hpp"
#include "host/app/calibrate/camera.hpp"
#include "host/app/calibrate/outcome.hpp"
#include "host/app/calibrate/set.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "host/app/calibrate/verdict.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

struct SolveCommand {
  std::string folder, out, report, store;
  std::string pictures, chessboard, serial;
  std::string target = "auto";
  std::vector<std::string> hold_out;
  std::optional<double> temp_c;
  bool install = false;
  bool json = false;
};

/// Path of the report without its ending: beside rig.json, or in the folder that --report names.
std::string report_stem(const SolveCommand& o) {
  namespace fs = std::filesystem;
  return o.report.empty() ? fs::path(o.out).replace_extension(".report").string()
                          : (fs::path(o.report) / "calibration").string();
}

/// A set that cannot be solved: poses and reason, before the error itself ends the program.
void tell_unsolved(const SolveCommand& o, const calib::MeasuredFolder& measured, const Error& error, double seconds) {
  for (const auto& note : measured.rejected) log::warn("calibrate", "pose {}: {}", note.pose, note.reason);
  if (!o.json) return;
  const Json json{{"verdict", "refused"},
                  {"reasons", {error.detail}},
                  {"poses_used", 0},
                  {"poses_rejected", notes_json(measured.rejected)},
                  {"seconds", seconds}};
  std::puts(json_text(json, 1).c_str());
}

/// rig.json, then its copy in the store; each whole or not at all.
Result<void> keep(const SolveCommand& o, const Outcome& outcome) {
  ENAMEL_TRY_ASSIGN(const std::string text, rig_text(outcome));
  ENAMEL_TRY(write_file(o.out, text));
  if (!o.install) return {};
  const calib::RigStore store(o.store.empty() ? calib::RigStore::default_folder() : o.store);
  ENAMEL_TRY_ASSIGN(const calib::StoredRig stored, store.install(text));
  log::info("calibrate", "installed for probe {}: {}", outcome.folder.nominal.serial, stored.path);
  return {};
}

/// The set, of the probe that --serial names. Error: kRigForeign when the set is of another one.
Result<calib::CalibFolder> open_set(const SolveCommand& o) {
  ENAMEL_TRY_ASSIGN(calib::CalibFolder folder, calib::open_calib_folder(o.folder));
  std::string& serial = folder.nominal.serial;
  if (!o.serial.empty() && !serial.empty() && serial != o.serial)
    return fail(ErrorCode::kRigForeign, o.folder + " is of probe " + serial + ", --serial says " + o.serial);
  if (serial.empty()) serial = o.serial;
  if (o.temp_c) folder.nominal.temp_c = o.temp_c;
  return folder;
}

/// What would make --install fail after all the solving.
Result<void> check_installable(const SolveCommand& o, const calib::CalibFolder& folder) {
  if (!o.install || calib::is_storable_serial(folder.nominal.serial)) return {};
  return fail(
      ErrorCode::kRigInvalid,
      o.folder + "/rig.json: --install needs the probe's serial (letters, digits, - _ .); state it by --serial");
}

/// A chessboard without fringes: the camera alone.
Result<int> run_camera(const SolveCommand& o) {
  if (o.pictures.empty() != o.chessboard.empty())
    return fail(ErrorCode::kUsage, "--pictures and --chessboard belong together");
  auto board = o.chessboard.empty() ? board_of(o.folder) : parse_board(o.chessboard);
  if (!board) return tl::unexpected<Error>(board.error());
  return solve_camera_job({o.folder, o.pictures, o.out, *board, o.json});
}

calib::SolveOptions solve_options(const SolveCommand& o, const calib::CalibFolder& folder) {
  calib::SolveOptions options;
  if (o.target == "perfect") options.shape = calib::ShapeChoice::kPerfect;
  if (o.target == "solve") options.shape = calib::ShapeChoice::kSolve;
  options.fringe_period_px = calib::finest_periods_px(folder);
  options.on_step = [](const std::string& step) { log::info("calibrate", "{}", step); };
  return options;
}

/// Report, files and verdict of a solved set. Value: exit code.
Result<int> conclude(const SolveCommand& o, const Outcome& outcome, const std::function<double()>& seconds) {
  const bool is_accepted = outcome.judgement.is_accepted;
  Json json = verdict_json(outcome.solution, outcome.judgement);
  json["steps"] = steps_json(outcome.steps);
  if (!o.report.empty()) ENAMEL_TRY(make_folder(o.report));
  ENAMEL_TRY(write_report(outcome, json, report_stem(o)));
  if (is_accepted) ENAMEL_TRY(keep(o, outcome));
  json["report"] = report_stem(o) + ".html";
  json["seconds"] = seconds();
  show_verdict(json, o.json);
  if (is_accepted) return 0;
  std::fputs((Error{ErrorCode::kCalibrationRefused, o.out + " is not written"}.message() + "\n").c_str(), stderr);
  return exit_code(ErrorCode::kCalibrationRefused);
}

Result<int> run_solve(const SolveCommand& o) {
  SteadyClock clock;
  const HostTime begin = clock.now();
  const auto seconds = [&] { return std::chrono::duration<double>(clock.now() - begin).count(); };
  ENAMEL_TRY_ASSIGN(const calib::CalibFolder folder, open_set(o));
  ENAMEL_TRY(check_installable(o, folder));
  ENAMEL_TRY_ASSIGN(calib::MeasuredFolder measured, measure(folder, clock));
  ENAMEL_TRY_ASSIGN(const auto held_out, take_held_out(o.hold_out, measured));
  auto solution = calib::solve(measured.views, folder.target, folder.nominal, solve_options(o, folder));
  if (!solution) {
    tell_unsolved(o, measured, solution.error(), seconds());
    return tl::unexpected<Error>(solution.error());
  }
  solution->rejected.insert(solution->rejected.begin(), measured.rejected.begin(), measured.rejected.end());
  solution->notes.insert(solution->notes.begin(), measured.notes.begin(), measured.notes.end());
  const auto& judges = held_out.empty() ? solution->poses : held_out;
  const calib::DepthRange range = range_of(folder.nominal);
  auto planes = check_planes(folder, judges, solution->state, measured.ripple);
  const auto judgement = calib::judge(*solution, std::move(planes), !held_out.empty(), range);
  const auto steps = calib::step_effects(*solution, judges, folder.target, measured.ripple, range);
  return conclude(o, {folder, measured, *solution, judgement, steps}, seconds);
}

}  // namespace

CalibrateCommand add_calibrate_solve(CLI::App& app) {
  auto o = std::make_shared<SolveCommand>();
  CLI::App* solve = app.add_subcommand("solve", "calibration from a calibration folder");
  solve->add_option("DIR", o->folder, "calibration folder: rig.json, target.json, poses/")->required();
  solve->add_option("--out", o->out, "rig.json to write; nothing is written when the calibration is refused")
      ->required();
  solve->add_option("--report", o->report, "folder of calibration.html and .json (default: beside rig.json)");
  solve->add_option("--target", o->target, "the target's shape: perfect, solve it too, or whichever the data ask for")
      ->check(CLI::IsMember({"auto", "perfect", "solve"}))
      ->capture_default_str();
  solve->add_option("--hold-out", o->hold_out, "poses that only judge")->delimiter(',');
  solve->add_option("--serial", o->serial, "the probe, where the set's rig.json does not say");
  solve->add_option("--temp-c", o->temp_c, "the probe's temperature, where the set's rig.json does not say");
  solve->add_flag("--install", o->install, "make it the probe's current calibration when it is accepted");
  solve->add_option("--store", o->store,
                    "folder of installed calibrations (default $ENAMEL_CALIBRATIONS, else the "
                    "user's data folder)");
  solve->add_flag("--json", o->json, "one JSON object on stdout");
  solve->add_option("--pictures", o->pictures, "camera alone: names of plain pictures in DIR, e.g. 'left*.jpg'");
  solve->add_option("--chessboard", o->chessboard, "with --pictures: inner corners and square in mm, e.g. 9x6x25");
  return {solve, [o] {
            const bool is_camera = !o->pictures.empty() || !o->chessboard.empty() || is_camera_set(o->folder);
            return is_camera ? run_camera(*o) : run_solve(*o);
          }};
}

}  // namespace enamel::app
