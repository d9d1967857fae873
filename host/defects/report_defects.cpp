#include "host/defects/report_defects.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace enamel::host {
namespace {

bool is_surveyed(DefectClass c) {
  return c == DefectClass::kStitching || c == DefectClass::kTissue || c == DefectClass::kReliability ||
         c == DefectClass::kHumidity;
}

/// False where it is not one of ours.
bool read(const nlohmann::json& json, Defect& out) {
  if (!json.is_object()) return false;
  const auto number = [&](const char* key, double& value) {
    const auto it = json.find(key);
    if (it == json.end() || !it->is_number()) return false;
    value = it->get<double>();
    return true;
  };
  const auto kind = json.find("class"), place = json.find("p_model_mm"), words = json.find("words");
  if (kind == json.end() || place == json.end() || words == json.end() || !kind->is_string() || !words->is_string())
    return false;
  const auto name = std::ranges::find(kDefectNames, kind->get<std::string>());
  if (name == kDefectNames.end() || !place->is_array() || place->size() != 3) return false;
  out.kind = static_cast<DefectClass>(name - kDefectNames.begin());
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(*place)[k].is_number()) return false;
    out.p_model_mm[static_cast<Eigen::Index>(k)] = (*place)[k].get<double>();
  }
  out.words = words->get<std::string>();
  return number("size_mm2", out.size_mm2) && number("value", out.value) && number("limit", out.limit) &&
         number("confidence", out.confidence);
}

}  // namespace

Result<std::vector<Defect>> surveyed_defects(const std::string& report_json) {
  const auto report = nlohmann::json::parse(report_json, nullptr, /*allow_exceptions=*/false);
  if (!report.is_object()) return fail(ErrorCode::kConfigSyntax, "report.json is no JSON object: replay the scan");
  std::vector<Defect> out;
  const auto list = report.find("defects");
  if (list == report.end() || !list->is_array()) return out;
  for (const auto& each : *list) {
    Defect d;
    if (read(each, d) && is_surveyed(d.kind)) out.push_back(std::move(d));
  }
  return out;
}

void add_normals(Mesh& mesh) {
  mesh.normals.assign(mesh.vertices.size(), Vec3f::Zero());
  for (const auto& t : mesh.triangles) {
    const Vec3f n = (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    for (const std::uint32_t v : t) mesh.normals[v] += n;
  }
  for (Vec3f& n : mesh.normals) n = n.squaredNorm() > 0 ? n.normalized() : Vec3f::UnitZ();
}

}  // namespace enamel::host
