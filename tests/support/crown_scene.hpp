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
  /// 0: two crowns side by side. Else one of many scenes drawn by this number: crowns' place, height, roundness and
  /// share of height that the flank keeps, where cliffs, shadows and the wet spot lie, how dark gum is.
  std::uint64_t layout = 0;
};

struct CrownBurst {
  FrameSet frames;
  Map<double> phase_rad;   ///< true, absolute
  Map<float> carrier_rad;  ///< of a flat surface at mid-height: what a calibration tells
  Map<std::uint8_t> lit;
};

[[nodiscard]] CrownBurst render_crowns(const CrownScene& scene);

}  // namespace enamel::test
