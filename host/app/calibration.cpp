#include "host/app/calibration.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "calib/io/rig_writer.hpp"
#include "calib/model/measuring_rig.hpp"
#include "host/app/input.hpp"
#include "host/record/calibration_attachment.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/sha256.hpp"

namespace enamel::app {

namespace {

using Json = nlohmann::json;

Json parsed(const std::string& text) {
  Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  return json.is_object() ? json : Json::object();
}

/// The file's own `sha256` where it states one, else that of its bytes.
std::string identity(const calib::Rig& rig) {
  const Json json = parsed(rig.text);
  if (json.contains("sha256") && json["sha256"].is_string()) return json["sha256"].get<std::string>();
  return sha256_hex(std::as_bytes(std::span<const char>(rig.text)));
}

}  // namespace

Result<Calibration> load_calibration(const std::string& path) {
  Calibration c;
  ENAMEL_TRY_ASSIGN(c.rig, calib::load_rig(path));
  if (!calib::is_rig_intact(c.rig.text))
    return fail(ErrorCode::kRigInvalid, path + ": its sha256 is not that of its content; it was changed after solving");
  const auto report = read_file(std::filesystem::path(path).replace_extension(".report.json").string());
  if (report) c.report_json = *report;
  c.source = path;
  return c;
}

Result<Calibration> calibration_for(const std::string& path, host::BurstStream& stream, const std::string& input) {
  if (!path.empty()) return load_calibration(path);
  Calibration c;
  if (const std::string text = attached_text(stream, host::kCalibrationAttachment); !text.empty()) {
    ENAMEL_TRY_ASSIGN(c.rig, calib::parse_rig(text));
    c.report_json = attached_text(stream, host::kCalibrationReportAttachment);
    c.source = "recording";
    return c;
  }
  if (stream.rig_text().empty()) return fail(ErrorCode::kRigMissing, input);
  ENAMEL_TRY_ASSIGN(c.rig, calib::parse_rig(stream.rig_text()));
  c.source = "probe";
  return c;
}

Result<calib::Rig> rig_to_measure(const Calibration& calibration, const host::BurstStream& stream) {
  const bool is_whole = calibration.rig.patterns.mode != calib::PatternMode::kMulti;
  if (is_whole || stream.rig_text().empty()) return calibration.rig;
  ENAMEL_TRY_ASSIGN(const calib::Rig device, calib::parse_rig(stream.rig_text()));
  return calib::measuring_rig(calibration.rig, device);
}

std::string calibration_json(const Calibration& c, const std::string& device_serial) {
  const Json file = parsed(c.rig.text), report = parsed(c.report_json);
  const bool is_foreign = !device_serial.empty() && !c.rig.serial.empty() && device_serial != c.rig.serial;
  Json out{{"source", c.source},
           {"sha256", identity(c.rig)},
           {"serial", c.rig.serial},
           {"nominal", file.contains("nominal") && file["nominal"] == true},
           {"foreign", is_foreign}};
  if (file.contains("calibrated_at")) out["calibrated_at"] = file["calibrated_at"];
  if (report.contains("verdict")) out["verdict"] = report["verdict"];
  if (report.contains("expected") && report["expected"].contains("p95_um")) {
    out["expected_p95_um"] = report["expected"]["p95_um"];
    out["expected_p95_bound_um"] = report["expected"].value("p95_bound_um", 0.0);
  }
  return out.dump();
}

}  // namespace enamel::app
