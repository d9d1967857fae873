// Bodies that come between the probe and the teeth, or lie beside them, and move by themselves.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

namespace enamel::twin {

enum class MoverKind : std::uint8_t { kTongue, kCheek, kFinger, kCotton };

inline constexpr std::array<std::pair<std::string_view, MoverKind>, 4> kMoverKinds{{{"tongue", MoverKind::kTongue},
                                                                                    {"cheek", MoverKind::kCheek},
                                                                                    {"finger", MoverKind::kFinger},
                                                                                    {"cotton", MoverKind::kCotton}}};
[[nodiscard]] constexpr std::string_view name_of(MoverKind kind) {
  return kMoverKinds[static_cast<std::size_t>(kind)].first;
}

struct MoverConfig {
  MoverKind kind = MoverKind::kTongue;
  double share = 0.1;      ///< part of the scan's time that it is there
  double visit_s = 2.0;    ///< length of a visit, about
  double speed_mm_s = 15;  ///< peak speed of its wobbling while it is there
  double depth_mm = 3;     ///< how far its top stands above the surface looked at, towards the probe
  double reach_mm = 0;     ///< how far it comes in over the middle of the view; negative: stays beside
  double follow = 0.3;     ///< part of the probe's way that it goes along with
  double albedo = 0;       ///< 0: its kind's own
  std::uint64_t seed = 0;  ///< added to the scene's
  bool mucosa = false;     ///< tongue and cheek return light as gum does; not a key: where teeth are not plaster
};

}  // namespace enamel::twin
