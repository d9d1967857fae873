// enamel calibrate axes: the desktop scanner's two axes from pictures of a coded board that lies on its table.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "calib/io/rig_writer.hpp"
#include "calib/mount/mount_solve.hpp"
#include "calib/mount/rig_uncertainty.hpp"
#include "host/app/calibrate/mount_report.hpp"
#include "host/app/calibrate/set.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

struct AxesCommand {
  std::string folder, rig, out, report;
  bool json = false;
};

/// Angles and pictures of every usable pose. Error: kTargetFile for a target whose dots do not say which they are.
Result<std::vector<calib::MountStop>> gather(const calib::CalibFolder& folder, const Clock& clock,
                                             std::vector<calib::StopNote>& unusable) {
  if (folder.target.type != calib::TargetType::kCodedDots) {
    return fail(ErrorCode::kTargetFile, folder.path +
                                            "/target.json: a board that is seen in part has to be of type "
                                            "coded_dots; `enamel calibrate target coded` makes one");
  }
  ENAMEL_TRY_ASSIGN(const auto angles, calib::read_pose_axes(folder.path, folder.poses));
  ENAMEL_TRY_ASSIGN(calib::MeasuredFolder measured, measure(folder, clock));
  for (const auto& note : measured.rejected) unusable.push_back({note.pose, note.reason});
  std::vector<calib::MountStop> stops;
  const bool has_fringes = !folder.cycles_u.empty() && !folder.cycles_v.empty();
  for (calib::PoseView& view : measured.views) {
    if (has_fringes)
      for (calib::DotView& dot : view.dots) measured.ripple.remove(dot.samples);
    const auto at = std::find(folder.poses.begin(), folder.poses.end(), view.name) - folder.poses.begin();
    stops.push_back({std::move(view), angles[static_cast<std::size_t>(at)]});
  }
  return stops;
}

/// The new file in place of an older one, which stays beside it as *.previous.json.
Result<void> keep(const std::string& path, const calib::Mount& mount) {
  ENAMEL_TRY_ASSIGN(const std::string text, calib::mount_text(mount));
  if (const auto older = read_file(path); older && calib::is_mount_text(*older)) {
    ENAMEL_TRY(write_file(std::filesystem::path(path).replace_extension(".previous.json").string(), *older));
  }
  return write_file(path, text);
}

Result<int> run_axes(const AxesCommand& o) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, load_intact(o.rig));
  ENAMEL_TRY_ASSIGN(calib::CalibFolder folder, calib::open_calib_folder(o.folder, calib::FringeNeed::kNone));
  std::vector<calib::StopNote> unusable;
  ENAMEL_TRY_ASSIGN(auto stops, gather(folder, clock, unusable));
  const calib::MountOptions options{.rig_covariance = calib::rig_covariance_of(rig)};
  auto solution = calib::solve_mount(std::move(stops), folder.target, calib::state_of(rig), options);
  if (!solution) {
    if (o.json) std::puts(json_text(unsolved_json(solution.error(), unusable), 1).c_str());
    return tl::unexpected<Error>(solution.error());
  }
  solution->left_out.insert(solution->left_out.begin(), unusable.begin(), unusable.end());
  solution->mount.serial = rig.serial;
  solution->mount.calibrated_at = calib::capture_time_utc(o.folder);
  const Json json = mount_json(*solution);
  const bool is_accepted = json["verdict"] == "accepted";
  if (!o.report.empty()) ENAMEL_TRY(write_file(o.report, mount_page(*solution, json)));
  if (is_accepted) ENAMEL_TRY(keep(o.out, solution->mount));
  o.json ? static_cast<void>(std::puts(json_text(json, 1).c_str())) : print_mount(json);
  if (is_accepted) return 0;
  std::fputs((Error{ErrorCode::kCalibrationRefused, o.out + " is not written"}.message() + "\n").c_str(), stderr);
  return exit_code(ErrorCode::kCalibrationRefused);
}

}  // namespace

CalibrateCommand add_calibrate_axes(CLI::App& app) {
  auto o = std::make_shared<AxesCommand>();
  CLI::App* axes = app.add_subcommand("axes", "the desktop scanner's axes from a coded board on its table");
  axes->add_option("DIR", o->folder, "calibration folder with axes.csv: rig.json, target.json, poses/")->required();
  axes->add_option("--rig", o->rig, "solved rig.json of this scanner")->required();
  axes->add_option("--out", o->out,
                   "mount.json to write; an older one stays as *.previous.json; nothing is written when "
                   "the calibration is refused")
      ->required();
  axes->add_option("--report", o->report, "HTML page to write");
  axes->add_flag("--json", o->json, "one JSON object on stdout");
  return {axes, [o] { return run_axes(*o); }};
}

}  // namespace enamel::app
