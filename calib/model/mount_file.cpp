// mount.json to values and back.
#include <nlohmann/json.hpp>
#include <utility>

#include "calib/model/json_object.hpp"
#include "calib/model/json_seal.hpp"
#include "calib/model/json_section.hpp"
#include "calib/model/mount.hpp"
#include "protocol/base/file.hpp"

namespace enamel::calib {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "enamel-mount";
constexpr const char* kTruthFormat = "enamel-mount-truth";
constexpr int kSchema = 1;
constexpr double kMaxPlace_mm = 1e4;
constexpr double kMaxHarmonic_deg = 5;  // more is another drive, not an error of this one
constexpr double kMaxBacklash_deg = 10;
constexpr double kMaxCorrection_deg = 5;
constexpr double kUnitTolerance = 1e-6;  // six written decimals of a unit vector pass

AxisLine read_axis(JsonSection s) {
  AxisLine line;
  const auto direction = s.numbers("direction", 3), point = s.numbers("point_mm", 3),
             harmonic = s.numbers("harmonic_deg", 2);
  double length = 0;
  for (const double d : direction) length += d * d;
  length = std::sqrt(length);
  if (!(std::abs(length - 1) < kUnitTolerance)) s.refuse("direction", "must be a unit vector");
  for (std::size_t i = 0; i < 3; ++i) {
    line.direction[i] = length > 0 ? direction[i] / length : 0;
    line.point_mm[i] = point[i];
    if (!(std::abs(point[i]) <= kMaxPlace_mm)) s.refuse("point_mm", "lies beyond 10 m: no place of an axis");
  }
  for (std::size_t i = 0; i < 2; ++i) {
    line.harmonic_rad[i] = harmonic[i] * kRadPerDegree;
    if (!(std::abs(harmonic[i]) <= kMaxHarmonic_deg)) s.refuse("harmonic_deg", "must be from -5 to 5 degrees");
  }
  if (s.has("backlash_deg")) line.backlash_rad = s.number_within("backlash_deg", 0, kMaxBacklash_deg) * kRadPerDegree;
  if (s.has("approach")) {
    const std::string side = s.string("approach");
    if (side != "positive" && side != "negative") s.refuse("approach", "must be positive or negative");
    line.approach = side == "negative" ? -1 : 1;
  }
  return line;
}

void read_corrections(const nlohmann::json& json, JsonSection& top, Mount& mount, Faults& faults) {
  if (!top.has("stop_corrections")) return;
  if (!json["stop_corrections"].is_array()) return top.refuse("stop_corrections", "must be a list");
  for (std::size_t i = 0; i < json["stop_corrections"].size(); ++i) {
    const auto& entry = json["stop_corrections"][i];
    const std::string prefix = "stop_corrections[" + std::to_string(i) + "]";
    if (!entry.is_object()) return top.refuse("stop_corrections", "must hold objects");
    JsonSection s(entry, prefix + ".", faults);
    StopCorrection c{
        .pose = s.string("pose"),
        .rotation_rad = s.number_within("rot_deg", -kMaxCorrection_deg, kMaxCorrection_deg) * kRadPerDegree,
        .swing_rad = s.number_within("swing_deg", -kMaxCorrection_deg, kMaxCorrection_deg) * kRadPerDegree};
    mount.stop_corrections.push_back(std::move(c));
  }
}

void read_covariance(const nlohmann::json& json, JsonSection& top, Mount& mount, Faults& faults) {
  if (!top.has("covariance")) return;
  if (!json["covariance"].is_object()) return top.refuse("covariance", "must be an object");
  JsonSection s(json["covariance"], "covariance.", faults);
  const auto names = mount_parameter_names();
  const auto& parameters = json["covariance"].value("parameters", nlohmann::json::array());
  if (!s.has("parameters") || !parameters.is_array() || parameters.size() != names.size())
    return s.refuse("parameters", "must be the " + std::to_string(names.size()) + " names of schema 1");
  for (std::size_t i = 0; i < names.size(); ++i)
    if (parameters[i] != names[i])
      return s.refuse("parameters", std::string("must name ") + names[i] + " at its place");
  mount.covariance.parameters.assign(names.begin(), names.end());
  mount.covariance.matrix = s.matrix("matrix", names.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i)
    if (mount.covariance.matrix[i * names.size() + i] < 0) s.refuse("matrix", "has a negative variance");
}

void check_seal(const nlohmann::json& json, std::string_view text, Faults& faults) {
  if (!json.contains("sha256")) return;
  if (!is_sealed(Json::parse(text, nullptr, /*allow_exceptions=*/false)))
    faults.add("sha256", "is not that of the content: the file was changed after it was solved; calibrate again");
}

Json axis_json(const AxisLine& line) {
  return {{"direction", line.direction},
          {"point_mm", line.point_mm},
          {"harmonic_deg", {line.harmonic_rad[0] / kRadPerDegree, line.harmonic_rad[1] / kRadPerDegree}},
          {"backlash_deg", line.backlash_rad / kRadPerDegree},
          {"approach", line.approach < 0 ? "negative" : "positive"}};
}

Json covariance_json(const MountCovariance& c) {
  Json rows = Json::array();
  const std::size_t n = c.parameters.size();
  for (std::size_t r = 0; r < n; ++r)
    rows.push_back(std::vector<double>(c.matrix.begin() + static_cast<std::ptrdiff_t>(r * n),
                                       c.matrix.begin() + static_cast<std::ptrdiff_t>((r + 1) * n)));
  return {{"parameters", c.parameters}, {"matrix", rows}};
}

}  // namespace

bool is_mount_text(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  return json.is_object() && json.contains("format") && (json["format"] == kFormat || json["format"] == kTruthFormat);
}

Result<Mount> parse_mount(std::string_view text) {
  ENAMEL_TRY_ASSIGN(const auto json, parse_json_object(text, ErrorCode::kMountInvalid));
  Faults faults;
  JsonSection top(json, "", faults);
  const std::string format = top.string("format");
  if (format != kFormat && format != kTruthFormat) top.refuse("format", std::string("must be ") + kFormat);
  if (top.integer("schema", 1, 1'000'000) != kSchema)
    top.refuse("schema", "is of a later version: this program reads schema 1; update it or calibrate again");
  Mount mount;
  mount.rotation = read_axis(top.section("rotation"));
  mount.swing = read_axis(top.section("swing"));
  if (format == kFormat || top.has("serial")) mount.serial = top.string("serial");
  if (format == kFormat) {
    mount.calibrated_at = top.string("calibrated_at");
    read_corrections(json, top, mount, faults);
    read_covariance(json, top, mount, faults);
  }
  if (faults.first().empty()) check_seal(json, text, faults);
  if (!faults.first().empty()) return fail(ErrorCode::kMountInvalid, "mount: " + faults.first());
  return mount;
}

Result<Mount> load_mount(const std::string& path) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  auto mount = parse_mount(text);
  if (!mount) return fail(mount.error().code, path + ": " + mount.error().detail);
  return mount;
}

Result<std::string> mount_text(const Mount& mount) {
  Json json{{"format", kFormat},
            {"schema", kSchema},
            {"serial", mount.serial},
            {"calibrated_at", mount.calibrated_at},
            {"rotation", axis_json(mount.rotation)},
            {"swing", axis_json(mount.swing)}};
  json["stop_corrections"] = Json::array();
  for (const StopCorrection& c : mount.stop_corrections) {
    json["stop_corrections"].push_back(
        {{"pose", c.pose}, {"rot_deg", c.rotation_rad / kRadPerDegree}, {"swing_deg", c.swing_rad / kRadPerDegree}});
  }
  if (!mount.covariance.parameters.empty()) json["covariance"] = covariance_json(mount.covariance);
  std::string text = sealed_text(std::move(json));
  ENAMEL_TRY(parse_mount(text));
  return text;
}

}  // namespace enamel::calib
