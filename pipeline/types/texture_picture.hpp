// How a burst's surface looks, with form and illumination taken out.
#pragma once

#include <cstdint>

#include "pipeline/types/map.hpp"

namespace enamel {

/// Block means of the grey image beside those of their surroundings, on the camera's own pixels, lens errors included.
struct TexturePicture {
  static constexpr std::uint8_t kUnknown = 0;
  int step = 1;            ///< picture pixel (i, j) is the mean of camera pixels step*i … step*i + step-1
  double range = 0;        ///< grey 128 + 127 is (1 + range) times as bright as its surroundings
  Map<std::uint8_t> grey;  ///< 128: as bright as its surroundings
};

}  // namespace enamel
