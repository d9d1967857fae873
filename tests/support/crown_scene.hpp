// One burst of four plain frames of a row of crowns on a gum bed, made for unwrapping: cliffs on one flank, a shadow, a
// wet spot. Known absolute phase. No code: what counts is what neighbours alone can tell.
#pragma once

#include <cstdint>

#include "pipeline/types/map.hpp"
#include "tests/unit/decode/folder_burst.hpp"

namespace enamel::test {

struct CrownScene {
  int width = 640, height = 480;
  double period_px = 27;
  double noise_dn = 2;
  std::uint64_t seed = 1;
};

struct CrownBurst {
  FrameSet frames;
  Map<double> phase_rad;   ///< true, absolute
  Map<float> carrier_rad;  ///< of a flat surface at mid-height: what a calibration tells
  Map<std::uint8_t> lit;
};

[[nodiscard]] CrownBurst render_crowns(const CrownScene& scene);

}  // namespace enamel::test
