// What a probe fresh from the factory believes of itself: the design values, off the truth by manufacturing tolerances.
#pragma once

#include <cstdint>
#include <string>

#include "calib/model/rig.hpp"
#include "tools/twin/optics/multi_patterns.hpp"

namespace enamel::twin {

/// rig.json with "nominal": true, lenses without distortion, focal lengths off by up to 0.3 %, principal points by up
/// to 3 px, the projector's place by up to 0.15 mm and 0.2 degrees, drawn by the seed; pattern set `multi`. frames: how
/// many are averaged into a picture; 1 is not mentioned. Error: kRigInvalid.
[[nodiscard]] Result<std::string> nominal_rig_text(const calib::Rig& truth, const MultiPatterns& patterns, int frames,
                                                   std::uint64_t seed);

}  // namespace enamel::twin
