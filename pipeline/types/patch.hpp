// What one burst says about the surface, in camera coordinates (mm) at mid-burst.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/shade.hpp"

namespace enamel {

inline constexpr std::uint8_t kNoOrder = 255;

/// Organised surface patch: all maps have the camera's size. Immutable once published.
struct SurfacePatch {
  Map<float> depth_mm;    ///< camera z; NaN = none; one independent measurement a pixel, not smoothed
  Map<float> sigma_mm;    ///< one standard deviation of depth_mm; NaN where depth is NaN
  Map<Vec3f> points;      ///< camera frame, NaN = none; from depth_mm
  Map<Vec3f> normals;     ///< unit, towards the camera; NaN = none
  Map<float> texture_dn;  ///< fringe-free grey image A (DN above black), valid everywhere
  Map<float> modulation_dn;
  std::size_t valid_px = 0;
  ShadeMap shade = {};  ///< empty where the burst shows nothing translucent: plaster
};

}  // namespace enamel
