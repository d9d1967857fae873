// What stands between the probe and a good surface, as one burst shows it, and how much light came from inside.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace enamel {

enum class SightTrouble : std::uint8_t {
  kNone,
  kGlare,  ///< spots at full scale, as on something wet
  kMetal,  ///< a large place that keeps the fringes' contrast among tissue that does not
  kLamp,   ///< light without fringes on surfaces, or unlike from frame to frame: another lamp shines there
  kFog,    ///< light without fringes everywhere alike: the window is fogged
};
inline constexpr std::size_t kSightTroubles = 5;  ///< layout: number of them

inline constexpr std::array<std::string_view, kSightTroubles> kSightTroubleNames = {"none", "glare", "metal", "lamp",
                                                                                    "fog"};
[[nodiscard]] constexpr std::string_view name_of(SightTrouble t) noexcept {
  return kSightTroubleNames[static_cast<std::size_t>(t)];
}

/// Of an apparent depth: one standard deviation of what it is off by. chosen: by judgement; what is known of enamel,
/// dentine and gum in blue light is known to a factor of two.
inline constexpr double kApparentDepthUnsure = 0.5;

struct Sight {
  SightTrouble trouble = SightTrouble::kNone;
  float x_px = 0, y_px = 0;     ///< middle of a glare or of metal in the camera's image
  float spoilt_share = 0;       ///< of the image's lit pixels: at full scale
  float veil_dn = 0;            ///< light above black that no fringe is in, where the burst shows it
  float translucent_share = 0;  ///< of measured pixels: contrast so low that light comes back from inside
  float apparent_depth_mm = 0;  ///< mean of what such pixels were lifted by
};

}  // namespace enamel
