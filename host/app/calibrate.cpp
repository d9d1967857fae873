// enamel calibrate: from pictures of a target to rig.json, and what a rig.json is worth.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/io/rig_writer.hpp"
#include "calib/judge/judgement.hpp"
#include "calib/judge/step_effect.hpp"
#include "calib/solve/measure_folder.hpp"
#include "host/app/calibrate_bar.hpp"
#include "host/app/command.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/progress.hpp"

namespace enamel::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr calib::DepthRange kFallbackRange{40, 56};  // of the reference design, for rigs that state none

struct Options {
  std::string folder, out, rig, other;
  std::string target = "auto";
  std::vector<std::string> hold_out;
  BarOptions bar;
  bool json = false;
};

calib::DepthRange range_of(const calib::Rig& rig) {
  if (!rig.depth_range) {
    log::warn("calibrate", "rig.json states no depth_range_mm: judged over {} to {} mm", kFallbackRange.near_mm,
              kFallbackRange.far_mm);
  }
  return rig.depth_range.value_or(kFallbackRange);
}

Json notes_json(const std::vector<calib::PoseNote>& notes) {
  Json out = Json::array();
  for (const auto& note : notes) out.push_back({{"pose", note.pose}, {"reason", note.reason}});
  return out;
}

Json planes_json(const std::vector<calib::PlaneCheck>& planes) {
  Json out = Json::array();
  for (const auto& p : planes) {
    out.push_back({{"pose", p.pose},
                   {"points", p.points},
                   {"depth_mm", p.depth_mm},
                   {"rms_um", p.rms_um},
                   {"sag_um", p.shape.sag_um()},
                   {"twist_um", p.shape.twist_um}});
  }
  return out;
}

/// sag_um, twist_um and their standard errors at 1/8, 1/2 and 7/8 of the depth range.
void add_shapes(Json& json, const std::array<calib::DepthShape, 3>& shapes) {
  for (const auto& s : shapes) {
    json["depth_mm"].push_back(s.depth_mm);
    json["sag_um"].push_back(s.shape.sag_um());
    json["sag_sigma_um"].push_back(std::max(s.sigma.sag_x_um, s.sigma.sag_y_um));
    json["twist_um"].push_back(s.shape.twist_um);
    json["twist_sigma_um"].push_back(s.sigma.twist_um);
  }
}

Json steps_json(const std::vector<calib::StepEffect>& steps) {
  Json out = Json::array();
  for (const auto& s : steps) {
    out.push_back({{"step", s.step},
                   {"plane_rms_um", s.plane_rms_um},
                   {"plane_rms_sigma_um", s.plane_rms_sigma_um},
                   {"plane_p95_um", s.plane_p95_um},
                   {"sag_um", s.sag_um},
                   {"sag_sigma_um", s.sag_sigma_um}});
  }
  return out;
}

Json verdict_json(const calib::Solution& s, const calib::Judgement& j) {
  Json json{{"verdict", j.is_accepted ? "accepted" : "refused"}, {"reasons", j.reasons}};
  json["rms_camera_px"] = s.result.rms_camera_px;
  json["rms_projector_px"] = s.result.rms_projector_px;
  json["poses_used"] = s.poses.size();
  json["poses_rejected"] = notes_json(s.rejected);
  add_shapes(json, j.shapes);
  json["plane_rms_um"] = j.plane_rms_um;
  json["plane_noise_um"] = j.plane_noise_um;
  json["plane_unexplained_um"] = j.plane_unexplained_um;
  json["planes_held_out"] = j.are_planes_held_out;
  json["planes"] = planes_json(j.planes);
  json["expected"] = {{"p95_um", j.predicted.p95_um},
                      {"p95_bound_um", j.bound.p95_um},
                      {"p95_without_scale_um", j.predicted.shape_p95_um},
                      {"scale_ppm", j.predicted.scale_ppm}};
  json["target_shape_solved"] = s.is_shape_solved;
  json["notes"] = s.notes;
  return json;
}

void print(const Json& json) {
  std::printf("%s\n", json["verdict"].get<std::string>().c_str());
  for (const auto& reason : json["reasons"]) std::printf("  because %s\n", reason.get<std::string>().c_str());
  std::printf("reprojection rms   camera %.4f px, projector %.4f px\n", json["rms_camera_px"].get<double>(),
              json["rms_projector_px"].get<double>());
  std::printf("expected error     %.2f um (95 %% of the volume), at most %.2f um, scale %.0f ppm\n",
              json["expected"]["p95_um"].get<double>(), json["expected"]["p95_bound_um"].get<double>(),
              json["expected"]["scale_ppm"].get<double>());
  std::printf("planes, rms        %.2f um%s\n", json["plane_rms_um"].get<double>(),
              json["planes_held_out"].get<bool>() ? "" : " (took part in the solution)");
  for (std::size_t k = 0; k < json["sag_um"].size(); ++k) {
    std::printf("at %5.1f mm        sag %6.3f +- %.3f um, twist %6.3f +- %.3f um over 16 mm\n",
                json["depth_mm"][k].get<double>(), json["sag_um"][k].get<double>(),
                json["sag_sigma_um"][k].get<double>(), json["twist_um"][k].get<double>(),
                json["twist_sigma_um"][k].get<double>());
  }
  for (const auto& s : json["steps"]) {
    std::printf("after %-12s planes %.4f +- %.4f um rms, %.3f um p95, sag or twist %.3f +- %.3f um\n",
                s["step"].get<std::string>().c_str(), s["plane_rms_um"].get<double>(),
                s["plane_rms_sigma_um"].get<double>(), s["plane_p95_um"].get<double>(), s["sag_um"].get<double>(),
                s["sag_sigma_um"].get<double>());
  }
  std::printf("poses used         %d\n", json["poses_used"].get<int>());
  for (const auto& p : json["poses_rejected"])
    std::printf("pose %s left out: %s\n", p["pose"].get<std::string>().c_str(), p["reason"].get<std::string>().c_str());
  for (const auto& n : json["notes"]) std::printf("note: %s\n", n.get<std::string>().c_str());
}

void show(const Json& json, bool as_json) {
  as_json ? static_cast<void>(std::puts(json.dump(1).c_str())) : print(json);
}

/// Planes of the named poses by a rig; poses whose ground cannot be used are passed over with a warning.
std::vector<calib::PlaneCheck> check_planes(const calib::CalibFolder& folder, const std::vector<calib::PoseView>& views,
                                            const calib::RigState& rig, const calib::Ripple& ripple) {
  std::vector<calib::PlaneCheck> planes;
  if (folder.target.type != calib::TargetType::kCircleGrid) return planes;
  for (const calib::PoseView& view : views) {
    auto plane = calib::check_plane(view, folder.target, rig, ripple);
    if (plane) {
      planes.push_back(std::move(*plane));
    } else {
      log::warn("calibrate", "{}", plane.error().detail);
    }
  }
  return planes;
}

Result<calib::MeasuredFolder> measure(const calib::CalibFolder& folder, const Clock& clock) {
  Progress progress(clock, "measuring poses", folder.poses.size());
  return calib::measure_folder(folder, [&] { progress.advance(); });
}

/// Moves the views of the held-out poses out of `measured`. Error: kUsage for a name that is no usable pose.
Result<std::vector<calib::PoseView>> take_held_out(const Options& o, calib::MeasuredFolder& measured) {
  std::vector<calib::PoseView> held;
  for (const std::string& name : o.hold_out) {
    const auto at = std::find_if(measured.views.begin(), measured.views.end(),
                                 [&](const calib::PoseView& v) { return v.name == name; });
    if (at == measured.views.end())
      return fail(ErrorCode::kUsage, "--hold-out " + name + ": no usable pose of that name");
    held.push_back(std::move(*at));
    measured.views.erase(at);
  }
  return held;
}

Result<void> write_rig(const Options& o, const calib::CalibFolder& folder, const calib::MeasuredFolder& measured,
                       const calib::Solution& solution) {
  calib::SolvedRig solved{.camera = solution.state.camera,
                          .projector = solution.state.projector,
                          .T_proj_cam = solution.state.T_proj_cam,
                          .parameter_names = {},
                          .covariance = solution.result.covariance,
                          .calibrated_at = calib::capture_time_utc(o.folder),
                          .response = measured.response,
                          .correction = solution.state.correction,
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
  ENAMEL_TRY_ASSIGN(const auto held_out, take_held_out(o, measured));
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
  const auto& judges = held_out.empty() ? solution->poses : held_out;
  auto planes = check_planes(folder, judges, solution->state, measured.ripple);
  const auto judgement = calib::judge(*solution, std::move(planes), !held_out.empty(), range_of(folder.nominal));
  if (judgement.is_accepted) ENAMEL_TRY(write_rig(o, folder, measured, *solution));
  Json json = verdict_json(*solution, judgement);
  json["steps"] =
      steps_json(calib::step_effects(*solution, judges, folder.target, measured.ripple, range_of(folder.nominal)));
  json["seconds"] = seconds();
  show(json, o.json);
  if (judgement.is_accepted) return 0;
  std::fputs((Error{ErrorCode::kCalibrationRefused, o.out + " is not written"}.message() + "\n").c_str(), stderr);
  return exit_code(ErrorCode::kCalibrationRefused);
}

Result<calib::Rig> load_intact(const std::string& path) {
  ENAMEL_TRY_ASSIGN(calib::Rig rig, calib::load_rig(path));
  if (!calib::is_rig_intact(rig.text))
    return fail(ErrorCode::kRigInvalid, path + ": its sha256 is not that of its content; it was changed after solving");
  return rig;
}

Result<int> run_bar(const Options& o, const calib::Rig& rig) {
  ENAMEL_TRY_ASSIGN(const Json json, check_bar(rig, o.bar));
  std::puts(json.dump(1).c_str());
  return json["verdict"] == "accepted" ? 0 : exit_code(ErrorCode::kCalibrationRefused);
}

Result<int> run_check(const Options& o) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, load_intact(o.rig));
  if (!o.bar.capture.empty()) return run_bar(o, rig);
  if (o.folder.empty()) return fail(ErrorCode::kUsage, "calibrate check wants a calibration folder or --bar");
  ENAMEL_TRY_ASSIGN(const calib::CalibFolder folder, calib::open_calib_folder(o.folder));
  if (!rig.serial.empty() && !folder.nominal.serial.empty() && rig.serial != folder.nominal.serial) {
    return fail(ErrorCode::kRigForeign,
                o.rig + " is of probe " + rig.serial + ", the pictures are of probe " + folder.nominal.serial);
  }
  ENAMEL_TRY_ASSIGN(calib::MeasuredFolder measured, measure(folder, clock));
  const std::vector<calib::PoseView> views = o.hold_out.empty() ? measured.views : std::vector<calib::PoseView>{};
  ENAMEL_TRY_ASSIGN(const auto chosen, take_held_out(o, measured));
  const auto planes = check_planes(folder, o.hold_out.empty() ? views : chosen, calib::state_of(rig), measured.ripple);
  double squares = 0, points = 0;
  for (const auto& p : planes) {
    squares += p.rms_um * p.rms_um * static_cast<double>(p.points);
    points += static_cast<double>(p.points);
  }
  Json json{{"plane_rms_um", points > 0 ? std::sqrt(squares / points) : 0.0}};
  add_shapes(json, calib::shapes_over_depth(planes, range_of(rig)));
  json["planes"] = planes_json(planes);
  json["poses_rejected"] = notes_json(measured.rejected);
  std::puts(json.dump(1).c_str());
  return 0;
}

Result<int> run_compare(const Options& o) {
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, load_intact(o.rig));
  ENAMEL_TRY_ASSIGN(const calib::Rig other, load_intact(o.other));
  const auto d = calib::compare_rigs(calib::state_of(rig), calib::state_of(other), range_of(other));
  Json json{{"p95_um", d.p95_um}, {"rms_um", d.rms_um}, {"max_um", d.max_um}, {"scale_ppm", d.scale_ppm}};
  for (std::size_t k = 0; k < d.planes.size(); ++k) {
    json["depth_mm"].push_back(d.depth_mm[k]);
    json["sag_um"].push_back(d.planes[k].sag_um());
    json["twist_um"].push_back(d.planes[k].twist_um);
  }
  std::puts(json.dump(1).c_str());
  return 0;
}

void add_solve(CLI::App& app, Options& o) {
  CLI::App* solve = app.add_subcommand("solve", "calibration from a calibration folder");
  solve->add_option("DIR", o.folder, "calibration folder: rig.json, target.json, poses/")->required();
  solve->add_option("--out", o.out, "rig.json to write; nothing is written when the calibration is refused")
      ->required();
  solve->add_option("--target", o.target, "the target's shape: perfect, solve it too, or whichever the data ask for")
      ->check(CLI::IsMember({"auto", "perfect", "solve"}))
      ->capture_default_str();
  solve->add_option("--hold-out", o.hold_out, "poses that only judge")->delimiter(',');
  solve->add_flag("--json", o.json, "one JSON object on stdout");
}

}  // namespace

Run add_calibrate(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.require_subcommand(1);
  add_solve(app, *o);
  CLI::App* check = app.add_subcommand("check", "planes or a two-sphere bar as a rig sees them (JSON)");
  check->add_option("DIR", o->folder, "calibration folder: its planes");
  check->add_option("--rig", o->rig, "rig.json to judge")->required();
  check->add_option("--poses", o->hold_out, "only these poses")->delimiter(',');
  check->add_option("--bar", o->bar.capture, "recording or exchange folder of a two-sphere bar at rest");
  check->add_option("--bar-mm", o->bar.design_mm, "its diameters, the smaller first, and the distance")->delimiter(',');
  check->add_option("--bursts", o->bar.bursts, "bursts of the bar to measure")->delimiter(',')->capture_default_str();
  CLI::App* compare = app.add_subcommand("compare", "what the difference of two rigs does to geometry (JSON)");
  compare->add_option("RIG", o->rig, "rig.json")->required();
  compare->add_option("REFERENCE", o->other, "rig.json")->required();
  return [o, check, compare]() -> Result<int> {
    if (check->parsed()) return run_check(*o);
    if (compare->parsed()) return run_compare(*o);
    return run_solve(*o);
  };
}

}  // namespace enamel::app
