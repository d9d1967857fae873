#include "host/app/calibrate/mount_report.hpp"

#include <cstdio>

#include "calib/model/rig.hpp"
#include "calib/report/report.hpp"
#include "protocol/base/xml.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMaxDirection_deg = 0.003, kMaxPlace_um = 3;
constexpr const char* kPerfectRig =
    "rig.json states no covariance: the rig is taken for perfect, and the sigmas are smaller than the truth";
constexpr double kReach_mm = 30;  // of an arch from the field's middle

Json axis_json(const calib::AxisLine& line, const calib::LineSigma& sigma, bool is_play_seen) {
  Json json{
      {"direction", line.direction},
      {"point_mm", line.point_mm},
      {"harmonic_deg", {line.harmonic_rad[0] * calib::kDegreesPerRad, line.harmonic_rad[1] * calib::kDegreesPerRad}},
      {"direction_sigma_deg", sigma.direction_rad * calib::kDegreesPerRad},
      {"place_sigma_um", sigma.place_mm * 1000}};
  json["backlash_deg"] = is_play_seen ? Json(line.backlash_rad * calib::kDegreesPerRad) : Json();
  return json;
}

Json notes_of(const std::vector<calib::StopNote>& notes) {
  Json out = Json::array();
  for (const calib::StopNote& note : notes) out.push_back({{"pose", note.pose}, {"reason", note.reason}});
  return out;
}

bool is_direction_known(const calib::LineSigma& sigma) {
  return sigma.direction_rad * calib::kDegreesPerRad <= kMaxDirection_deg;
}

bool is_place_known(const calib::LineSigma& sigma) { return sigma.place_mm * 1000 <= kMaxPlace_um; }

Json reasons_of(const calib::MountSolution& s) {
  struct Line {
    const char* name;
    const calib::LineSigma &all, &by_pictures;
  };
  const Line lines[] = {{"rotation", s.rotation, s.rotation_by_pictures}, {"swing", s.swing, s.swing_by_pictures}};
  Json reasons = Json::array();
  const auto add = [&](const char* name, const char* what, bool is_of_rig) {
    reasons.push_back(std::string(name) + " axis: its " + what +
                      (is_of_rig ? "; the rig's own uncertainty leaves it open: calibrate the rig with more poses"
                                 : "; take more stops, wider apart"));
  };
  for (const Line& line : lines) {
    if (!is_direction_known(line.all))
      add(line.name, "direction is not known to 0.003 degrees", is_direction_known(line.by_pictures));
    if (!is_place_known(line.all)) add(line.name, "place is not known to 3 um", is_place_known(line.by_pictures));
  }
  return reasons;
}

std::string number(const Json& value, const char* form) {
  char text[64];
  std::snprintf(text, sizeof text, form, value.get<double>());
  return text;
}

}  // namespace

Json mount_json(const calib::MountSolution& s) {
  const Json reasons = reasons_of(s);
  Json json{{"verdict", reasons.empty() ? "accepted" : "refused"}, {"reasons", reasons}};
  json["rotation"] = axis_json(s.mount.rotation, s.rotation, s.is_rotation_play_seen);
  json["swing"] = axis_json(s.mount.swing, s.swing, s.is_swing_play_seen);
  json["with_rig_uncertainty"] = s.has_rig_share;
  json["misfit"] = s.misfit;
  json["stop_sigma_deg"] = {s.stop_sigma_rad[0] * calib::kDegreesPerRad, s.stop_sigma_rad[1] * calib::kDegreesPerRad};
  json["wobble_sigma_um"] = s.wobble_sigma_mm * 1000;
  json["stops_used"] = s.stops.size();
  json["stops_left_out"] = notes_of(s.left_out);
  json["stops"] = Json::array();
  for (const calib::StopResult& r : s.stops) {
    json["stops"].push_back({{"pose", r.pose},
                             {"rot_deg", r.rotation_rad * calib::kDegreesPerRad},
                             {"swing_deg", r.swing_rad * calib::kDegreesPerRad},
                             {"shift_um", r.shift_mm.norm() * 1000},
                             {"dots", r.dots},
                             {"rms_camera_px", r.rms_camera_px},
                             {"rms_projector_px", r.rms_projector_px}});
  }
  return json;
}

Json unsolved_json(const Error& error, const std::vector<calib::StopNote>& unusable) {
  return {
      {"verdict", "refused"}, {"reasons", {error.detail}}, {"stops_used", 0}, {"stops_left_out", notes_of(unusable)}};
}

void print_mount(const Json& json) {
  std::printf("%s\n", json["verdict"].get<std::string>().c_str());
  for (const auto& reason : json["reasons"]) std::printf("  because %s\n", reason.get<std::string>().c_str());
  for (const char* axis : {"rotation", "swing"}) {
    const Json& a = json[axis];
    std::printf("%-9s direction  %.6f %.6f %.6f +- %.5f deg\n", axis, a["direction"][0].get<double>(),
                a["direction"][1].get<double>(), a["direction"][2].get<double>(),
                a["direction_sigma_deg"].get<double>());
    std::printf("%-9s point      %.4f %.4f %.4f mm +- %.2f um\n", axis, a["point_mm"][0].get<double>(),
                a["point_mm"][1].get<double>(), a["point_mm"][2].get<double>(), a["place_sigma_um"].get<double>());
    std::printf("%-9s harmonic   %.4f %.4f deg\n", axis, a["harmonic_deg"][0].get<double>(),
                a["harmonic_deg"][1].get<double>());
  }
  std::printf("stops     %zu used, their angles scatter by %.4f and %.4f deg, their places by %.2f um; misfit %.2f\n",
              json["stops_used"].get<std::size_t>(), json["stop_sigma_deg"][0].get<double>(),
              json["stop_sigma_deg"][1].get<double>(), json["wobble_sigma_um"].get<double>(),
              json["misfit"].get<double>());
  if (!json["with_rig_uncertainty"].get<bool>()) std::printf("rig       %s\n", kPerfectRig);
  for (const auto& p : json["stops_left_out"])
    std::printf("stop %s left out: %s\n", p["pose"].get<std::string>().c_str(), p["reason"].get<std::string>().c_str());
}

std::string mount_page(const calib::MountSolution& s, const Json& json) {
  const auto verdict = json["verdict"].get<std::string>();
  std::string head = "<p class=\"verdict " + verdict + "\">" + verdict + "</p>\n<ul>";
  for (const auto& reason : json["reasons"]) head += "<li>" + xml_escaped(reason.get<std::string>()) + "</li>";
  head += "</ul>\n<table><tr><th>axis</th><th>direction, sigma</th><th>place, sigma</th></tr>";
  for (const char* axis : {"rotation", "swing"}) {
    head += std::string("<tr><td>") + axis + "</td><td>" + number(json[axis]["direction_sigma_deg"], "%.5f°") +
            "</td><td>" + number(json[axis]["place_sigma_um"], "%.2f µm") + "</td></tr>";
  }
  head += "</table>";
  if (!s.has_rig_share) head += std::string("<p>") + kPerfectRig + "</p>";
  std::string stops =
      "<table><tr><th>stop</th><th>rotation</th><th>swing</th><th>shift</th><th>dots</th><th>camera rms</th>"
      "<th>projector rms</th></tr>";
  for (const auto& r : json["stops"]) {
    stops += "<tr><td>" + xml_escaped(r["pose"].get<std::string>()) + "</td><td>" + number(r["rot_deg"], "%.4f°") +
             "</td><td>" + number(r["swing_deg"], "%.4f°") + "</td><td>" + number(r["shift_um"], "%.2f µm") +
             "</td><td>" + std::to_string(r["dots"].get<std::size_t>()) + "</td><td>" +
             number(r["rms_camera_px"], "%.4f px") + "</td><td>" + number(r["rms_projector_px"], "%.4f px") +
             "</td></tr>";
  }
  stops += "</table><ul class=\"notes\">";
  for (const calib::StopNote& n : s.left_out) stops += "<li>" + xml_escaped(n.pose + ": " + n.reason) + "</li>";
  stops += "</ul>";
  const std::string of = s.mount.serial.empty() ? "" : " of scanner " + s.mount.serial;
  return calib::page_of("Axes" + of, {{"Verdict", head}, {"Stops", stops}});
}

Json mount_difference_json(const calib::Mount& a, const calib::Mount& b) {
  const calib::Triple middle{0, 0, calib::kUsualDepthMm};
  Json json;
  const std::pair<const char*, calib::LineDifference> lines[] = {
      {"rotation", calib::compare_lines(a.rotation, b.rotation, middle, kReach_mm)},
      {"swing", calib::compare_lines(a.swing, b.swing, middle, kReach_mm)}};
  for (const auto& [name, d] : lines)
    json[name] = {{"angle_deg", d.angle_rad * calib::kDegreesPerRad}, {"distance_um", d.distance_mm * 1000}};
  return json;
}

}  // namespace enamel::app
