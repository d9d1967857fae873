#include "host/app/calibrate/verdict.hpp"

#include <algorithm>
#include <cstdio>
#include <string>

#include "protocol/base/json_text.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

void print_verdict(const Json& json) {
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
  for (const auto& step : json["steps"]) {
    std::printf("after %-12s planes %.4f +- %.4f um rms, %.3f um p95, sag or twist %.3f +- %.3f um\n",
                step["step"].get<std::string>().c_str(), step["plane_rms_um"].get<double>(),
                step["plane_rms_sigma_um"].get<double>(), step["plane_p95_um"].get<double>(),
                step["sag_um"].get<double>(), step["sag_sigma_um"].get<double>());
  }
  std::printf("poses used         %d\n", json["poses_used"].get<int>());
  for (const auto& p : json["poses_rejected"])
    std::printf("pose %s left out: %s\n", p["pose"].get<std::string>().c_str(), p["reason"].get<std::string>().c_str());
  for (const auto& n : json["notes"]) std::printf("note: %s\n", n.get<std::string>().c_str());
  std::printf("report             %s\n", json["report"].get<std::string>().c_str());
}

}  // namespace

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

Json parameters_json(const std::vector<calib::RigParameter>& parameters) {
  Json out = Json::array();
  for (const auto& p : parameters) {
    out.push_back(
        {{"name", p.name}, {"value", p.value}, {"sigma", p.sigma ? Json(*p.sigma) : Json()}, {"unit", p.unit}});
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

void show_verdict(const Json& json, bool as_json) {
  as_json ? static_cast<void>(std::puts(json_text(json, 1).c_str())) : print_verdict(json);
}

}  // namespace enamel::app
