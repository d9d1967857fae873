// How a burst's surface looks, with form and illumination taken out.
#pragma once

#include <cstdint>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel {

/// Block means of the grey image beside those of their surroundings, on the camera's own pixels, lens errors included.
struct TexturePicture {
  static constexpr std::uint8_t kUnknown = 0;
  int step = 1;            ///< picture pixel (i, j) is the mean of camera pixels step*i … step*i + step-1
  double range = 0;        ///< grey 128 + 127 is (1 + range) times as bright as its surroundings
  Map<std::uint8_t> grey;  ///< 128: as bright as its surroundings
};

/// Camera-frame point at the middle of block (i, j): that of a pixel, or between two where the step is even. NaN where
/// there is no surface.
[[nodiscard]] inline Vec3f block_point(const SurfacePatch& patch, int step, int i, int j) {
  const int u = i * step, v = j * step, below = (step - 1) / 2, above = step / 2;
  return 0.5F * (patch.points(u + below, v + below) + patch.points(u + above, v + above));
}

}  // namespace enamel
