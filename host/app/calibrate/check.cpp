// enamel calibrate check: planes of a calibration folder, a two-sphere bar or the overlaps of a scan, as a rig sees
// them.
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "host/app/calibrate/bar.hpp"
#include "host/app/calibrate/self_check.hpp"
#include "host/app/calibrate/set.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "host/app/calibrate/verdict.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

struct CheckOptions {
  std::string folder, rig;
  std::vector<std::string> poses;
  BarOptions bar;
  SelfCheckOptions scan;
};

Result<int> run_bar(const CheckOptions& o, const calib::Rig& rig) {
  ENAMEL_TRY_ASSIGN(const Json json, check_bar(rig, o.bar));
  std::puts(json_text(json, 1).c_str());
  return json["verdict"] == "accepted" ? 0 : exit_code(ErrorCode::kCalibrationRefused);
}

Result<int> run_self_check(const CheckOptions& o, const calib::Rig& rig) {
  ENAMEL_TRY_ASSIGN(const Json json, self_check(rig, o.scan));
  std::puts(json_text(json, 1).c_str());
  return json["verdict"] == "alarm" ? exit_code(ErrorCode::kCalibrationRefused) : 0;
}

Result<int> run_check(const CheckOptions& o) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, load_intact(o.rig));
  if (!o.bar.capture.empty()) return run_bar(o, rig);
  if (!o.scan.capture.empty()) return run_self_check(o, rig);
  if (o.folder.empty()) return fail(ErrorCode::kUsage, "calibrate check wants a calibration folder, --bar or --scan");
  ENAMEL_TRY_ASSIGN(const calib::CalibFolder folder, calib::open_calib_folder(o.folder));
  if (!rig.serial.empty() && !folder.nominal.serial.empty() && rig.serial != folder.nominal.serial) {
    return fail(ErrorCode::kRigForeign,
                o.rig + " is of probe " + rig.serial + ", the pictures are of probe " + folder.nominal.serial);
  }
  ENAMEL_TRY_ASSIGN(calib::MeasuredFolder measured, measure(folder, clock));
  const std::vector<calib::PoseView> views = o.poses.empty() ? measured.views : std::vector<calib::PoseView>{};
  ENAMEL_TRY_ASSIGN(const auto chosen, take_held_out(o.poses, measured));
  const auto planes = check_planes(folder, o.poses.empty() ? views : chosen, calib::state_of(rig), measured.ripple);
  double squares = 0, points = 0;
  for (const auto& p : planes) {
    squares += p.rms_um * p.rms_um * static_cast<double>(p.points);
    points += static_cast<double>(p.points);
  }
  Json json{{"plane_rms_um", points > 0 ? std::sqrt(squares / points) : 0.0}};
  add_shapes(json, calib::shapes_over_depth(planes, range_of(rig)));
  json["planes"] = planes_json(planes);
  json["poses_rejected"] = notes_json(measured.rejected);
  std::puts(json_text(json, 1).c_str());
  return 0;
}

}  // namespace

CalibrateCommand add_calibrate_check(CLI::App& app) {
  auto o = std::make_shared<CheckOptions>();
  CLI::App* check =
      app.add_subcommand("check", "planes, a two-sphere bar or a scan's overlaps as a rig sees them (JSON)");
  check->add_option("DIR", o->folder, "calibration folder: its planes");
  check->add_option("--rig", o->rig, "rig.json to judge")->required();
  check->add_option("--poses", o->poses, "only these poses")->delimiter(',');
  check->add_option("--bar", o->bar.capture, "recording or exchange folder of a two-sphere bar at rest");
  check->add_option("--bar-mm", o->bar.design_mm, "its diameters, the smaller first, and the distance")->delimiter(',');
  check->add_option("--bursts", o->bar.bursts, "bursts of the bar to measure")->delimiter(',')->capture_default_str();
  check->add_option("--scan", o->scan.capture, "recording or session folder of a scan: does it contradict the rig?");
  check->add_option("--views", o->scan.views, "bursts of the scan that take part at most")
      ->check(CLI::Range(20, 200))
      ->capture_default_str();
  return {check, [o] { return run_check(*o); }};
}

}  // namespace enamel::app
