#include "host/app/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "calib/io/rig_writer.hpp"
#include "calib/model/measuring_rig.hpp"
#include "calib/model/pattern.hpp"
#include "host/app/input.hpp"
#include "host/record/calibration_attachment.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/sha256.hpp"
#include "protocol/base/utc.hpp"

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

std::string covered(const calib::Rig& rig) {
  if (rig.temperature)
    return fmt::format("{:.1f} to {:.1f} C", rig.temperature->range_c[0], rig.temperature->range_c[1]);
  return fmt::format("{:.1f} C", rig.temp_c.value_or(0));
}

void add_age(Json& out, const calib::Rig& rig, const CalibrationUse& use, const CalibrationLimits& limits) {
  const auto taken = parse_utc(rig.calibrated_at), scanned = parse_utc(use.scanned_at);
  if (!taken || !scanned) return;
  const double days = std::chrono::duration<double, std::ratio<86400>>(*scanned - *taken).count();
  out["age_days"] = days;
  if (days > limits.max_age_days) {
    out["marks"].push_back(
        fmt::format("{:.0f} days old at the scan, the limit is {:.0f}: calibrate anew", days, limits.max_age_days));
  }
}

void add_temperature(Json& out, const calib::Rig& rig, const CalibrationUse& use, const CalibrationLimits& limits) {
  out["follows_temperature"] = rig.temperature.has_value();
  if (!use.burst_c) return;
  out["temp_c"] = *use.burst_c;
  const auto cold = calib::kelvins_beyond(rig, (*use.burst_c)[0]), warm = calib::kelvins_beyond(rig, (*use.burst_c)[1]);
  if (!cold || !warm) return;  // the file does not say at which temperature it was taken
  const double beyond = std::max(*cold, *warm);
  out["kelvins_beyond"] = beyond;
  if (beyond > limits.max_kelvins) {
    out["marks"].push_back(
        fmt::format("the bursts were taken {:.1f} K outside of the temperatures it covers: let the "
                    "probe come to {}, or calibrate at this temperature and join",
                    beyond, covered(rig)));
  }
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
  const bool is_whole = calib::is_burst_set(calibration.rig.patterns);
  if (is_whole || stream.rig_text().empty()) return calibration.rig;
  ENAMEL_TRY_ASSIGN(const calib::Rig device, calib::parse_rig(stream.rig_text()));
  return calib::measuring_rig(calibration.rig, device);
}

void bind(ConfigReader& reader, CalibrationLimits& limits) {
  reader.bind("calibration.max_age_days", limits.max_age_days, {1.0, 100000.0}, "an older calibration is marked");
  reader.bind("calibration.max_kelvins", limits.max_kelvins, {0.1, 100.0},
              "bursts so far outside of the temperatures that a calibration covers are marked");
}

std::string calibration_json(const Calibration& c, const CalibrationUse& use, const CalibrationLimits& limits) {
  const Json file = parsed(c.rig.text), report = parsed(c.report_json);
  const bool is_foreign = !use.device_serial.empty() && !c.rig.serial.empty() && use.device_serial != c.rig.serial;
  Json out{{"source", c.source},     {"sha256", identity(c.rig)},
           {"serial", c.rig.serial}, {"nominal", file.contains("nominal") && file["nominal"] == true},
           {"foreign", is_foreign},  {"marks", Json::array()}};
  if (is_foreign) out["marks"].push_back("of probe " + c.rig.serial + ", the bursts of probe " + use.device_serial);
  if (!c.rig.calibrated_at.empty()) out["calibrated_at"] = c.rig.calibrated_at;
  add_age(out, c.rig, use, limits);
  add_temperature(out, c.rig, use, limits);
  if (report.contains("verdict")) out["verdict"] = report["verdict"];
  if (report.contains("expected") && report["expected"].contains("p95_um")) {
    out["expected_p95_um"] = report["expected"]["p95_um"];
    out["expected_p95_bound_um"] = report["expected"].value("p95_bound_um", 0.0);
  }
  for (const auto& mark : out["marks"]) log::warn("calibration", "{}", mark.get<std::string>());
  return json_text(out);
}

}  // namespace enamel::app
