// The parts of one case, and how all of them come into one frame.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/cases/place_part.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

inline constexpr const char* kUpper = "upper";
inline constexpr const char* kLower = "lower";
inline constexpr const char* kBite = "bite";  ///< both in occlusion, seen from the side

/// upper, lower, bite, or die-NN with a tooth's number after FDI (ISO 3950) of permanent teeth. Errors: kUsage.
[[nodiscard]] Result<void> check_part(const std::string& name);
/// The part that it is laid on: a jaw on the bite, a die on its jaw; empty of the bite.
[[nodiscard]] std::string onto_of(const std::string& part);

/// Of one part that is laid on another.
struct PlacedPart {
  std::string name, onto;
  std::optional<Placement> placement;  ///< T_onto_name is `T_onto_part`
  Pose T_onto_part = Pose::Identity();
  std::string reason;  ///< where it has no placement
};

struct PlacedCase {
  std::vector<PlacedPart> parts;  ///< all but the bite, jaws first
  /// T_frame_part of everything that stands in the common frame, the bite's, which is among them.
  std::map<std::string, Pose> T_frame_part;
};

using CaseParts = std::map<std::string, std::unique_ptr<const LaidPart>>;

/// A part that cannot be placed is told, and does not hold up the others. Pure, deterministic.
[[nodiscard]] PlacedCase place_case(const CaseParts& parts, const PlaceConfig& config);

/// The placed parts as seen from where the bite was scanned, a colour each. PNG; empty where nothing is placed.
[[nodiscard]] std::vector<std::uint8_t> case_png(const CaseParts& parts, const PlacedCase& placed);

}  // namespace enamel::host
