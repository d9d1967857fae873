#include "host/defects/defect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/base/json_text.hpp"

namespace enamel::host {

std::string_view unit_of(DefectClass c) noexcept {
  switch (c) {
    case DefectClass::kHole:
      return "mm2";
    case DefectClass::kStitching:
    case DefectClass::kScanBody:
    case DefectClass::kFinishLine:
    case DefectClass::kNoise:
      return "um";
    case DefectClass::kBridge:
      return "mm";
    case DefectClass::kTissue:
    case DefectClass::kHumidity:
      return "bursts";
    case DefectClass::kReliability:
      return "views";
  }
  return "";
}

double confidence_of(double ratio) noexcept {
  const double beyond = std::max(ratio, 1.0);
  return beyond / (1.0 + beyond);
}

std::string defect_line(const Defect& d) {
  return fmt::format("{} at ({:.1f}, {:.1f}, {:.1f}), {:.1f} mm2: {}", name_of(d.kind), d.p_model_mm.x(),
                     d.p_model_mm.y(), d.p_model_mm.z(), d.size_mm2, d.words);
}

std::string defects_json(const std::vector<Defect>& defects) {
  nlohmann::json out = nlohmann::json::array();
  for (const Defect& d : defects) {
    out.push_back({{"class", name_of(d.kind)},
                   {"p_model_mm", {d.p_model_mm.x(), d.p_model_mm.y(), d.p_model_mm.z()}},
                   {"size_mm2", d.size_mm2},
                   {"value", d.value},
                   {"limit", d.limit},
                   {"unit", unit_of(d.kind)},
                   {"confidence", d.confidence},
                   {"words", d.words}});
  }
  return json_text(out);
}

std::string defects_summary(const std::vector<Defect>& defects) {
  std::array<std::size_t, kDefectClasses> counts{};
  for (const Defect& d : defects) ++counts[static_cast<std::size_t>(d.kind)];
  std::string out;
  for (std::size_t i = 0; i < kDefectClasses; ++i)
    if (counts[i] > 0) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", counts[i], kDefectNames[i]);
  return out;
}

}  // namespace enamel::host
