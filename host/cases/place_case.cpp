#include "host/cases/place_case.hpp"

#include <algorithm>
#include <utility>

namespace enamel::host {
namespace {

constexpr const char* kDie = "die-";

bool is_tooth(const std::string& number) {
  return number.size() == 2 && number[0] >= '1' && number[0] <= '4' && number[1] >= '1' && number[1] <= '8';
}

PlacedPart place(const std::string& name, const CaseParts& parts, const PlaceConfig& config) {
  PlacedPart out{name, onto_of(name), {}, Pose::Identity(), {}};
  const auto onto = parts.find(out.onto);
  if (onto == parts.end()) {
    out.reason = "there is no scan of part " + out.onto;
    return out;
  }
  // Views are asked of what shows the least besides: the bite of a jaw, the die of its jaw.
  const bool by_bite = out.onto == kBite;
  const LaidPart &part = *parts.at(name), &other = *onto->second;
  const auto placement = by_bite ? place_part(other, part, config) : place_part(part, other, config);
  if (!placement) {
    out.reason = placement.error().detail;
    return out;
  }
  out.placement = *placement;
  out.T_onto_part = by_bite ? placement->T_fixed_moving.inverse() : placement->T_fixed_moving;
  return out;
}

}  // namespace

Result<void> check_part(const std::string& name) {
  const bool die = name.starts_with(kDie) && is_tooth(name.substr(std::string(kDie).size()));
  if (die || name == kUpper || name == kLower || name == kBite) return {};
  return fail(ErrorCode::kUsage, name + ": a part is upper, lower, bite, or die-NN with the tooth's number, as die-36");
}

std::string onto_of(const std::string& part) {
  if (part == kBite) return {};
  if (!part.starts_with(kDie)) return kBite;
  return part[std::string(kDie).size()] < '3' ? kUpper : kLower;
}

PlacedCase place_case(const CaseParts& parts, const PlaceConfig& config) {
  PlacedCase out;
  std::vector<std::string> names;
  for (const char* jaw : {kUpper, kLower})
    if (parts.contains(jaw)) names.emplace_back(jaw);
  for (const auto& [name, part] : parts)
    if (name.starts_with(kDie)) names.push_back(name);
  if (parts.contains(kBite)) out.T_frame_part[kBite] = Pose::Identity();
  for (const std::string& name : names) {
    PlacedPart placed = place(name, parts, config);
    const auto onto = out.T_frame_part.find(placed.onto);
    if (placed.placement && onto != out.T_frame_part.end()) out.T_frame_part[name] = onto->second * placed.T_onto_part;
    out.parts.push_back(std::move(placed));
  }
  return out;
}

}  // namespace enamel::host
