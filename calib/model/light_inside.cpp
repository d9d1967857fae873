#include "calib/model/light_inside.hpp"

#include <nlohmann/json.hpp>
#include <vector>

#include "calib/model/json_object.hpp"
#include "calib/model/json_section.hpp"

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

}  // namespace enamel::calib
