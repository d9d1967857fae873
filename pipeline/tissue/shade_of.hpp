// The shade of a burst's surface: brightness without distance, slope and exposure, where light comes back from inside.
#pragma once

#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

/// How the burst was lit.
struct ShadeLight {
  Vec3f projector_mm = Vec3f::Zero();  ///< its centre, camera coordinates
  float opaque_contrast = 1;           ///< modulation / mean light of fringes on plaster
  float veil_dn = 0;                   ///< light above black that is not the surface's
  float exposure_ms = 1;               ///< of a frame, times the analogue gain
};

/// One value a cell of kShadeCell_px; what hangs over the image's edge is no cell. kNoShade where less than half of the
/// cell is measured, light falls in at more than 60 degrees, or the fringes keep half the contrast of plaster: metal,
/// and what else lets no light in. Pure; the same bits on every processor. An empty map for a patch without texture or
/// modulation of its size, or an exposure that is no length of time.
[[nodiscard]] ShadeMap shade_of(const SurfacePatch& patch, const ShadeLight& light);

/// Step of a brightness, DN / ms at 48 mm facing the light: 1 … 255. Of none (0, NaN): kNoShade.
[[nodiscard]] std::uint8_t shade_step(float brightness) noexcept;

}  // namespace enamel::pipeline
