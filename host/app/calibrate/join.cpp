// enamel calibrate join: calibrations of one probe at two temperatures or more become one that follows the temperature.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/io/rig_details.hpp"
#include "calib/io/rig_writer.hpp"
#include "calib/judge/volume.hpp"
#include "calib/solve/bundle.hpp"
#include "calib/solve/temperature_fit.hpp"
#include "host/app/calibrate/set.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

struct JoinOptions {
  std::vector<std::string> rigs;
  std::string out;
  bool json = false;
};

struct Joined {
  calib::Rig rig;
  calib::RigDetails details;
};

Result<Joined> load_one(const std::string& path, const std::string& serial) {
  ENAMEL_TRY_ASSIGN(calib::Rig rig, load_intact(path));
  if (!rig.temp_c) {
    return fail(ErrorCode::kRigInvalid, path + " states no temp_c: solve its set again with --temp-c");
  }
  if (!serial.empty() && rig.serial != serial)
    return fail(ErrorCode::kRigForeign, path + " is of probe " + rig.serial + ", the first of probe " + serial);
  calib::RigDetails details = calib::read_rig_details(rig);
  return Joined{std::move(rig), std::move(details)};
}

/// The first rig's file with the fit's values; the oldest of the sets dates it.
Result<std::string> text_of(const std::vector<Joined>& sets, const calib::TemperatureFit& fit) {
  calib::SolvedRig solved{.camera = fit.state.camera,
                          .projector = fit.state.projector,
                          .T_proj_cam = fit.state.T_proj_cam,
                          .parameter_names = {},
                          .covariance = fit.covariance,
                          .calibrated_at = sets[0].rig.calibrated_at,
                          .response = std::nullopt,
                          .correction = std::nullopt,
                          .temp_c = fit.terms.reference_c,
                          .temperature = fit.terms};
  for (const char* name : calib::rig_parameter_names()) solved.parameter_names.emplace_back(name);
  for (const Joined& set : sets) {
    solved.calibrated_at = std::min(solved.calibrated_at, set.rig.calibrated_at);
    if (!set.details.residuals) continue;
    solved.rms_camera_px = std::max(solved.rms_camera_px, set.details.residuals->rms_camera_px);
    solved.rms_projector_px = std::max(solved.rms_projector_px, set.details.residuals->rms_projector_px);
    solved.poses += set.details.residuals->poses;
    solved.is_shape_solved = solved.is_shape_solved || set.details.residuals->is_shape_solved;
  }
  return calib::solved_rig_text(sets[0].rig, solved);
}

Json describe(const JoinOptions& o, const calib::TemperatureFit& fit) {
  const calib::TemperatureTerms& t = fit.terms;
  Json json{{"out", o.out},
            {"reference_c", t.reference_c},
            {"range_c", t.range_c},
            {"chi2", fit.chi2},
            {"degrees_of_freedom", fit.degrees}};
  const std::array<double, calib::kTemperatureRates> rates{
      t.camera.fx,       t.camera.fy,         t.camera.cx,         t.camera.cy,        t.projector.fx,
      t.projector.fy,    t.projector.cx,      t.projector.cy,      t.rotation_rad[0],  t.rotation_rad[1],
      t.rotation_rad[2], t.translation_mm[0], t.translation_mm[1], t.translation_mm[2]};
  constexpr std::array<const char*, calib::kTemperatureRates> kNames{
      "camera fx",    "camera fy",  "camera cx",  "camera cy",  "projector fx",  "projector fy",  "projector cx",
      "projector cy", "rotation x", "rotation y", "rotation z", "translation x", "translation y", "translation z"};
  for (std::size_t k = 0; k < rates.size(); ++k) {
    json["per_kelvin"].push_back({{"name", kNames[k]},
                                  {"value", rates[k]},
                                  {"sigma", fit.sigma[static_cast<Eigen::Index>(k)]},
                                  {"unit", k < 8    ? "px/K"
                                           : k < 11 ? "rad/K"
                                                    : "mm/K"}});
  }
  return json;
}

void print_fit(const Json& json) {
  std::printf("%s: valid from %.1f to %.1f C\n", json["out"].get<std::string>().c_str(),
              json["range_c"][0].get<double>(), json["range_c"][1].get<double>());
  for (const auto& r : json["per_kelvin"]) {
    std::printf("%-14s %12.3g +- %-9.2g %s\n", r["name"].get<std::string>().c_str(), r["value"].get<double>(),
                r["sigma"].get<double>(), r["unit"].get<std::string>().c_str());
  }
}

Result<int> run_join(const JoinOptions& o) {
  std::vector<Joined> sets;
  std::vector<calib::RigAtTemperature> points;
  for (const std::string& path : o.rigs) {
    ENAMEL_TRY_ASSIGN(Joined set, load_one(path, sets.empty() ? "" : sets[0].rig.serial));
    points.push_back({calib::state_of(set.rig), set.details.covariance, *set.rig.temp_c});
    sets.push_back(std::move(set));
  }
  ENAMEL_TRY_ASSIGN(const calib::TemperatureFit fit, calib::fit_temperature(points));
  ENAMEL_TRY_ASSIGN(const std::string text, text_of(sets, fit));
  ENAMEL_TRY(write_file(o.out, text));
  const Json json = describe(o, fit);
  o.json ? static_cast<void>(std::puts(json_text(json, 1).c_str())) : print_fit(json);
  return 0;
}

}  // namespace

CalibrateCommand add_calibrate_join(CLI::App& app) {
  auto o = std::make_shared<JoinOptions>();
  CLI::App* join = app.add_subcommand("join", "calibrations at several temperatures into one that follows them");
  join->add_option("RIG", o->rigs, "solved rig.json files of one probe, 3 K apart or more")
      ->required()
      ->expected(2, 20);
  join->add_option("--out", o->out, "rig.json to write")->required();
  join->add_flag("--json", o->json, "one JSON object on stdout");
  return {join, [o] { return run_join(*o); }};
}

}  // namespace enamel::app
