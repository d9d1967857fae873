#include "host/cases/case_file.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "protocol/base/json_text.hpp"

namespace enamel::host {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMicron = 1e3;  // in a millimetre

Json matrix_json(const Pose& T) {
  Json rows = Json::array();
  for (int r = 0; r < 4; ++r) rows.push_back({T(r, 0), T(r, 1), T(r, 2), T(r, 3)});
  return rows;
}

Json facts_json(const PartFacts& part) {
  Json out{{"name", part.name},
           {"state", part.scanned ? "scanned" : "no mesh"},
           {"simulated", part.simulated},
           {"scanned_at", part.scanned_at},
           {"mount_serial", part.mount_serial},
           {"rig_serial", part.rig_serial},
           {"stops", part.stops}};
  if (part.fine_rms_um) out["fine_rms_um"] = *part.fine_rms_um;
  if (!part.older.empty()) out["older"] = part.older;
  return out;
}

Json placement_json(const PlacedPart& part) {
  Json out{{"part", part.name}, {"onto", part.onto}, {"placed", part.placement.has_value()}};
  if (!part.placement) {
    out["reason"] = part.reason;
    return out;
  }
  const Placement& p = *part.placement;
  out["area_mm2"] = p.area_mm2;
  out["consistency"] = p.consistency;
  out["rms_um"] = kMicron * p.rms_mm;
  out["form_rms_um"] = kMicron * p.form_rms_mm;
  out["sigma_um"] = kMicron * p.sigma_mm;
  out["sigma_deg"] = p.sigma_rad * 180 / std::numbers::pi;
  out["far_sigma_um"] = kMicron * p.far_sigma_mm;
  return out;
}

void doubt_serial(const std::vector<PartFacts>& parts, std::string PartFacts::*serial, const char* what,
                  std::vector<std::string>& out) {
  std::map<std::string, std::string> names;
  for (const PartFacts& part : parts) {
    if ((part.*serial).empty()) continue;
    std::string& of = names[part.*serial];
    of += (of.empty() ? "" : ", ") + part.name;
  }
  if (names.size() < 2) return;
  std::string text = std::string("parts of one case were scanned with different ") + what + ":";
  for (const auto& [of_serial, of_parts] : names) text += " " + of_serial + " (" + of_parts + ")";
  out.push_back(std::move(text));
}

}  // namespace

std::vector<std::string> serial_doubts(const std::vector<PartFacts>& parts) {
  std::vector<std::string> out;
  doubt_serial(parts, &PartFacts::mount_serial, "mounts", out);
  doubt_serial(parts, &PartFacts::rig_serial, "heads", out);
  return out;
}

std::string case_json(const std::vector<PartFacts>& parts, const PlacedCase* placed,
                      const std::vector<std::string>& warnings) {
  Json out{{"format", "enamel-case"}, {"version", 1}, {"units", "mm"}};
  out["simulated"] = std::ranges::any_of(parts, &PartFacts::simulated);
  out["parts"] = Json::array();
  for (const PartFacts& part : parts) out["parts"].push_back(facts_json(part));
  out["warnings"] = warnings;
  out["frame"] = placed != nullptr && placed->T_frame_part.size() > 1 ? Json(kBite) : Json(nullptr);
  out["placements"] = Json::array();
  if (placed == nullptr) return json_text(out, 1) + "\n";
  for (const PlacedPart& part : placed->parts) {
    out["placements"].push_back(placement_json(part));
    if (part.placement) out["T_" + part.onto + "_" + part.name] = matrix_json(part.T_onto_part);
  }
  return json_text(out, 1) + "\n";
}

}  // namespace enamel::host
