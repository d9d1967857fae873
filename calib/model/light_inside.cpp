#include "calib/model/light_inside.hpp"

#include <nlohmann/json.hpp>
#include <string>

#include "calib/model/json_object.hpp"
#include "calib/model/json_seal.hpp"
#include "calib/model/json_section.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::calib {
namespace {

constexpr const char* kSection = "light_inside";
constexpr int kMostBursts = 1'000'000;

}  // namespace

Result<std::optional<LightInside>> read_light_inside(std::string_view rig_text) {
  ENAMEL_TRY_ASSIGN(const auto json, parse_json_object(rig_text, ErrorCode::kRigInvalid));
  if (!json.contains(kSection)) return std::optional<LightInside>{};
  Faults faults;
  JsonSection s = JsonSection(json, "", faults).section(kSection);
  LightInside light;
  const std::vector<double> shares = s.matrix("of_enamel", 3, 3);
  for (std::size_t i = 0; i < shares.size() && i < 9; ++i) {
    light.of_enamel[i / 3][i % 3] = shares[i];
    if (!(shares[i] >= kLeastOfEnamel && shares[i] <= kMostOfEnamel)) s.refuse("of_enamel", "must be from 0.1 to 10");
  }
  light.sigma = s.number_within("sigma", 0, kMostOfEnamel);
  light.bursts = s.integer("bursts", 1, kMostBursts);
  if (!faults.first().empty()) return fail(ErrorCode::kRigInvalid, faults.first());
  return std::optional(light);
}

Result<std::string> with_light_inside(const Rig& rig, const LightInside& light) {
  auto json = nlohmann::ordered_json::parse(rig.text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return fail(ErrorCode::kRigInvalid, "the rig is no JSON object");
  json[kSection] = {{"of_enamel", light.of_enamel}, {"sigma", light.sigma}, {"bursts", light.bursts}};
  std::string text = json.contains("sha256") ? sealed_text(std::move(json)) : json_text(json, 1) + "\n";
  ENAMEL_TRY(parse_rig(text));
  return text;
}

}  // namespace enamel::calib
