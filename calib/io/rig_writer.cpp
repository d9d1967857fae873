#include "calib/io/rig_writer.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "calib/model/json_seal.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/utc.hpp"

namespace enamel::calib {
namespace {

// Keeps the keys in the order they were written in, so that the nominal file and the solved one can be laid side by
// side.
using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;

Json lens_json(const LensValues& l) {
  return {{"width", l.width}, {"height", l.height}, {"fx", l.fx},    {"fy", l.fy},
          {"cx", l.cx},       {"cy", l.cy},         {"dist", l.dist}};
}

Json matrix_json(const Eigen::MatrixXd& m) {
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < m.rows(); ++r) {
    Json row = Json::array();
    for (Eigen::Index c = 0; c < m.cols(); ++c) row.push_back(m(r, c));
    rows.push_back(row);
  }
  return rows;
}

Json temperature_json(const TemperatureTerms& t) {
  const auto drift = [](const LensDrift& l) -> Json {
    return {{"fx", l.fx}, {"fy", l.fy}, {"cx", l.cx}, {"cy", l.cy}};
  };
  return {{"reference_c", t.reference_c},
          {"range_c", t.range_c},
          {"per_kelvin",
           {{"camera", drift(t.camera)},
            {"projector", drift(t.projector)},
            {"rotation_rad", t.rotation_rad},
            {"translation_mm", t.translation_mm}}}};
}

}  // namespace

Result<std::string> solved_rig_text(const Rig& nominal, const SolvedRig& solved) {
  Json json = Json::parse(nominal.text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return fail(ErrorCode::kRigInvalid, "the nominal rig is no JSON object");
  json.erase("nominal");
  json["format"] = "rig/1";
  json["schema"] = kSchema;
  json["units"] = "mm";
  json["camera"] = lens_json(solved.camera);
  json["projector"] = lens_json(solved.projector);
  json["T_proj_cam"] = matrix_json(solved.T_proj_cam.matrix());
  if (!json.contains("serial")) json["serial"] = nominal.serial;
  json["calibrated_at"] = solved.calibrated_at;
  json["covariance"] = {{"parameters", solved.parameter_names}, {"matrix", matrix_json(solved.covariance)}};
  json["residuals"] = {{"rms_camera_px", solved.rms_camera_px},
                       {"rms_projector_px", solved.rms_projector_px},
                       {"poses", solved.poses},
                       {"target_shape_solved", solved.is_shape_solved}};
  if (solved.response) {
    json["response"] = {{"level", solved.response->level},
                        {"emission", solved.response->emission},
                        {"residual", solved.response->residual}};
  }
  json.erase("correction");  // that of an older solution
  if (const auto& f = solved.correction) {
    json["correction"] = {{"u_px", f->u_px},
                          {"v_px", f->v_px},
                          {"inverse_mm", f->inverse_mm},
                          {"terms", f->terms},
                          {"coefficients", f->coefficients}};
  }
  if (solved.temp_c) json["temp_c"] = *solved.temp_c;
  json.erase("temperature");
  if (solved.temperature) json["temperature"] = temperature_json(*solved.temperature);
  std::string text = sealed_text(std::move(json));
  ENAMEL_TRY(parse_rig(text));
  return text;
}

Result<std::string> with_light_inside(const Rig& rig, const LightInside& light) {
  auto json = Json::parse(rig.text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return fail(ErrorCode::kRigInvalid, "the rig is no JSON object");
  json["light_inside"] = {{"of_enamel", light.of_enamel}, {"sigma", light.sigma}, {"bursts", light.bursts}};
  std::string text = json.contains("sha256") ? sealed_text(std::move(json)) : json_text(json, 1) + "\n";
  ENAMEL_TRY(parse_rig(text));
  return text;
}

bool is_rig_intact(const std::string& text) {
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return false;
  return !json.contains("sha256") || is_sealed(json);
}

std::string capture_time_utc(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  fs::file_time_type newest = fs::file_time_type::min();
  for (const auto& entry : fs::recursive_directory_iterator(folder + "/poses", ignored))
    if (entry.is_regular_file(ignored)) newest = std::max(newest, entry.last_write_time(ignored));
  if (newest == fs::file_time_type::min()) return {};
  return utc_text(std::chrono::time_point_cast<WallTime::duration>(std::chrono::file_clock::to_sys(newest)));
}

}  // namespace enamel::calib
