#include "calib/io/rig_details.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "calib/io/rig_writer.hpp"

namespace enamel::calib {
namespace {

using SortedJson = nlohmann::json;

std::optional<double> number(const SortedJson& json, const char* key) {
  if (!json.is_object() || !json.contains(key) || !json[key].is_number()) return {};
  const double value = json[key].get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::string text_of(const SortedJson& json, const char* key) {
  return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
}

/// A square matrix of as many rows as names, or nothing.
void read_covariance(const SortedJson& json, RigDetails& out) {
  if (!json.is_object() || !json.contains("parameters") || !json.contains("matrix")) return;
  const SortedJson &names = json["parameters"], &rows = json["matrix"];
  if (!names.is_array() || !rows.is_array() || names.size() != rows.size()) return;
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd matrix(n, n);
  std::vector<std::string> parameters;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!names[r].is_string() || !rows[r].is_array() || rows[r].size() != rows.size()) return;
    parameters.push_back(names[r].get<std::string>());
    for (std::size_t c = 0; c < rows.size(); ++c) {
      if (!rows[r][c].is_number()) return;
      matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = rows[r][c].get<double>();
    }
  }
  out.parameter_names = std::move(parameters);
  out.covariance = std::move(matrix);
}

std::optional<RigResiduals> read_residuals(const SortedJson& json) {
  const auto camera = number(json, "rms_camera_px"), projector = number(json, "rms_projector_px");
  const auto poses = number(json, "poses");
  if (!camera || !projector || !poses) return {};
  RigResiduals r{.rms_camera_px = *camera, .rms_projector_px = *projector, .poses = static_cast<int>(*poses)};
  r.is_shape_solved = json.contains("target_shape_solved") && json["target_shape_solved"] == true;
  return r;
}

}  // namespace

RigDetails read_rig_details(const Rig& rig) {
  RigDetails out;
  out.serial = rig.serial;
  const SortedJson json = SortedJson::parse(rig.text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return out;
  out.is_nominal = json.contains("nominal") && json["nominal"] == true;
  out.calibrated_at = text_of(json, "calibrated_at");
  out.temp_c = number(json, "temp_c");
  out.sha256 = text_of(json, "sha256");
  if (json.contains("sha256")) out.seal = is_rig_intact(rig.text) ? RigSeal::kIntact : RigSeal::kBroken;
  if (json.contains("covariance")) read_covariance(json["covariance"], out);
  if (json.contains("residuals")) out.residuals = read_residuals(json["residuals"]);
  if (json.contains("response")) out.response_residual = number(json["response"], "residual");
  return out;
}

}  // namespace enamel::calib
