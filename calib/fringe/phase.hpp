// Four-step fringes of several frequencies to absolute projector coordinates. Frame k shows mean + amplitude *
// cos(phi + k pi/2), phi = 2 pi x / period, so that phi = atan2(I3 - I1, I0 - I2) (docs/calibration.md §2).
#pragma once

#include <array>
#include <span>

#include "calib/target/pixel_noise.hpp"
#include "pipeline/types/map.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

struct FringeLevel {
  int cycles = 0;  ///< periods across the projector's side
  std::array<Map<float>, 4> frames;
};

/// Projector coordinate of every pixel along one axis, px, NaN = none, and its variance from the pixels' noise.
struct CoordinateMap {
  Map<float> value_px;
  Map<float> variance_px2;
};

/// `levels` by rising cycles, the first with one; `side_px` = the projector's width (height). A pixel has a coordinate
/// when each level agrees with the next finer one within a quarter of its period and the finest phase is known to
/// better than 0.15 rad. Error: kCalibrationFolder when the first level has more than one cycle, or frames differ in
/// size.
[[nodiscard]] Result<CoordinateMap> decode_coordinate(std::span<const FringeLevel> levels, int side_px,
                                                      const PixelNoise& noise);

}  // namespace enamel::calib
