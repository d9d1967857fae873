#include <cmath>
#include <nlohmann/json.hpp>

#include "calib/model/json_object.hpp"
#include "host/defects/inspect.hpp"
#include "protocol/base/file.hpp"

namespace enamel::host {
namespace {

using Json = nlohmann::json;

constexpr double kMostMm = 1000;  // chosen: by judgement, no mouth is larger

auto refusal(const std::string& key, const std::string& what) {
  return fail(ErrorCode::kConfigValue, key + " " + what);
}

Result<double> length(const Json& of, const std::string& key, double least_mm, double otherwise_mm) {
  const auto it = of.find(key);
  if (it == of.end()) return otherwise_mm;
  const double mm = it->is_number() ? it->get<double>() : -1;
  if (!(mm >= least_mm && mm <= kMostMm)) return refusal(key, "must be a length in mm");
  return mm;
}

Result<Vec3d> place(const Json& of) {
  const auto it = of.find("p_top_mm");
  if (it == of.end() || !it->is_array() || it->size() != 3) return refusal("p_top_mm", "must be [x, y, z] in mm");
  Vec3d out;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(*it)[k].is_number() || !(std::abs((*it)[k].get<double>()) <= kMostMm))
      return refusal("p_top_mm", "must be [x, y, z] in mm");
    out[static_cast<Eigen::Index>(k)] = (*it)[k].get<double>();
  }
  return out;
}

Result<std::vector<Json>> list(const Json& json, const std::string& key) {
  const auto it = json.find(key);
  if (it == json.end()) return std::vector<Json>{};
  if (!it->is_array()) return refusal(key, "must be a list of objects");
  for (const Json& each : *it)
    if (!each.is_object()) return refusal(key, "must be a list of objects");
  return it->get<std::vector<Json>>();
}

Result<Marks> parse(const std::string& text) {
  ENAMEL_TRY_ASSIGN(const auto json, calib::parse_json_object(text, ErrorCode::kConfigSyntax));
  ENAMEL_TRY_ASSIGN(const auto bodies, list(json, "scan_bodies"));
  ENAMEL_TRY_ASSIGN(const auto stumps, list(json, "preparations"));
  for (const auto& [key, value] : json.items())
    if (key != "scan_bodies" && key != "preparations") return refusal(key, "is unknown: scan_bodies, preparations");
  Marks out;
  constexpr double kLeastMm = 0.1;
  for (const Json& body : bodies) {
    ScanBodyMark mark;
    ENAMEL_TRY_ASSIGN(mark.p_top_mm, place(body));
    ENAMEL_TRY_ASSIGN(mark.form.radius_mm, length(body, "radius_mm", kLeastMm, -1));
    ENAMEL_TRY_ASSIGN(mark.form.height_mm, length(body, "height_mm", kLeastMm, -1));
    ENAMEL_TRY_ASSIGN(mark.form.flat_mm, length(body, "flat_mm", 0, 0));
    if (mark.form.radius_mm < 0 || mark.form.height_mm < 0) return refusal("scan_bodies", "need radius_mm, height_mm");
    out.scan_bodies.push_back(mark);
  }
  for (const Json& stump : stumps) {
    PreparationMark mark;
    ENAMEL_TRY_ASSIGN(mark.p_top_mm, place(stump));
    ENAMEL_TRY_ASSIGN(mark.reach_mm, length(stump, "reach_mm", 1, mark.reach_mm));
    out.preparations.push_back(mark);
  }
  return out;
}

}  // namespace

Result<Marks> load_marks(const std::string& path) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  auto marks = parse(text);
  if (!marks) return fail(marks.error().code, path + ": " + marks.error().detail);
  return marks;
}

}  // namespace enamel::host
