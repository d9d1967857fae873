// enamel calibrate show: what a rig.json is.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/io/rig_details.hpp"
#include "calib/judge/judgement.hpp"
#include "calib/report/report.hpp"
#include "host/app/calibrate/set.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "host/app/calibrate/verdict.hpp"
#include "host/app/calibration.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/utc.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

struct ShowOptions {
  std::string rig;
  bool json = false;
};

const char* seal_text(calib::RigSeal seal) {
  switch (seal) {
    case calib::RigSeal::kIntact:
      return "valid";
    case calib::RigSeal::kBroken:
      return "broken";
    case calib::RigSeal::kAbsent:
      break;
  }
  return "absent";
}

/// What the file's own figures say against the limits of a calibration. The planes are in the pictures, not in the
/// file.
calib::Judgement judge_file(const calib::Rig& rig, const calib::RigDetails& d) {
  calib::Solution s;
  s.state = calib::state_of(rig);
  s.result.rms_camera_px = d.residuals->rms_camera_px;
  s.result.rms_projector_px = d.residuals->rms_projector_px;
  s.result.covariance = d.covariance;
  s.is_shape_solved = d.residuals->is_shape_solved;
  return calib::judge(s, {}, false, range_of(rig));
}

void add_verdict(Json& json, const calib::Rig& rig, const calib::RigDetails& d) {
  if (d.seal == calib::RigSeal::kBroken) {
    json["verdict"] = "refused";
    json["reasons"] = {"its sha256 is not that of its content: changed after solving; restore it or solve again"};
  } else if (d.is_nominal) {
    json["verdict"] = "design values";
    json["reasons"] = {"never solved: run `enamel calibrate solve`"};
  } else if (!d.residuals || d.covariance.rows() != calib::kRigParameters) {
    json["verdict"] = "unknown";
    json["reasons"] = {"the file states no residuals or no covariance: of another program or an older version"};
  } else {
    const calib::Judgement j = judge_file(rig, d);
    json["verdict"] = j.is_accepted ? "accepted" : "refused";
    json["reasons"] = j.reasons;
    json["expected"] = {{"p95_um", j.predicted.p95_um},
                        {"p95_bound_um", j.bound.p95_um},
                        {"p95_without_scale_um", j.predicted.shape_p95_um},
                        {"scale_ppm", j.predicted.scale_ppm}};
  }
}

Json describe(const std::string& path, const calib::Rig& rig) {
  const calib::RigDetails d = calib::read_rig_details(rig);
  Json json{{"file", path}, {"serial", rig.serial}, {"calibrated_at", d.calibrated_at}};
  if (const auto taken = parse_utc(d.calibrated_at)) {
    const double days = std::chrono::duration<double, std::ratio<86400>>(wall_time() - *taken).count();
    json["age_days"] = days;
    json["stale"] = days > CalibrationLimits{}.max_age_days;
  }
  json["temp_c"] = d.temp_c ? Json(*d.temp_c) : Json();
  json["sha256"] = seal_text(d.seal);
  add_verdict(json, rig, d);
  if (rig.temperature) json["temperature_range_c"] = rig.temperature->range_c;
  if (d.residuals) {
    json["residuals"] = {{"rms_camera_px", d.residuals->rms_camera_px},
                         {"rms_projector_px", d.residuals->rms_projector_px},
                         {"poses", d.residuals->poses},
                         {"target_shape_solved", d.residuals->is_shape_solved}};
  }
  if (d.response_residual) json["response_residual"] = *d.response_residual;
  json["parameters"] = parameters_json(calib::rig_parameters(calib::state_of(rig), d.covariance));
  return json;
}

std::string parameter_line(const Json& p) {
  const std::string sigma = p["sigma"].is_null() ? "-" : fmt::format("{:.2g}", p["sigma"].get<double>());
  return fmt::format("{:<18} {:>14.6f} +- {:<8} {}", p["name"].get<std::string>(), p["value"].get<double>(), sigma,
                     p["unit"].get<std::string>());
}

std::string or_dash(const std::string& text) { return text.empty() ? "-" : text; }

std::string age_text(const Json& json) {
  if (!json.contains("age_days")) return {};
  return fmt::format(", {:.0f} days ago{}", json["age_days"].get<double>(),
                     json["stale"].get<bool>() ? ": stale, calibrate anew" : "");
}

void print_rig(const Json& json) {
  std::printf("%s: %s\n", json["file"].get<std::string>().c_str(), json["verdict"].get<std::string>().c_str());
  for (const auto& reason : json["reasons"]) std::printf("  because %s\n", reason.get<std::string>().c_str());
  std::printf("probe              %s\n", or_dash(json["serial"]).c_str());
  std::printf("calibrated         %s%s\n", or_dash(json["calibrated_at"]).c_str(), age_text(json).c_str());
  std::printf("temperature        %s\n",
              json["temp_c"].is_null() ? "-" : fmt::format("{:.1f} C", json["temp_c"].get<double>()).c_str());
  std::printf("sha256             %s\n", json["sha256"].get<std::string>().c_str());
  if (json.contains("residuals")) {
    const Json& r = json["residuals"];
    std::printf("reprojection rms   camera %.4f px, projector %.4f px, %d poses\n", r["rms_camera_px"].get<double>(),
                r["rms_projector_px"].get<double>(), r["poses"].get<int>());
  }
  if (json.contains("expected")) {
    const Json& e = json["expected"];
    std::printf("expected error     %.2f um (95 %% of the volume), at most %.2f um, scale %.0f ppm\n",
                e["p95_um"].get<double>(), e["p95_bound_um"].get<double>(), e["scale_ppm"].get<double>());
  }
  for (const auto& p : json["parameters"]) std::printf("%s\n", parameter_line(p).c_str());
}

Result<int> run_show(const ShowOptions& o) {
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, calib::load_rig(o.rig));
  const Json json = describe(o.rig, rig);
  o.json ? static_cast<void>(std::puts(json_text(json, 1).c_str())) : print_rig(json);
  return json["sha256"] == "broken" ? exit_code(ErrorCode::kRigInvalid) : 0;
}

}  // namespace

CalibrateCommand add_calibrate_show(CLI::App& app) {
  auto o = std::make_shared<ShowOptions>();
  CLI::App* show = app.add_subcommand("show", "what a rig.json is: probe, time, parameters with sigma, verdict");
  show->add_option("RIG", o->rig, "rig.json")->required();
  show->add_flag("--json", o->json, "one JSON object on stdout");
  return {show, [o] { return run_show(*o); }};
}

}  // namespace enamel::app
