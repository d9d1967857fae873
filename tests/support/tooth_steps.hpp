// Random rows of teeth before a rig, made to mislead whoever counts fringes: cliffs all round, one tooth higher than
// the gum by exactly one fringe, gaps of 0.3 to 2 mm that are deep or dark, isolated patches of 10 x 10 px, modulation
// down to a tenth of the mean light, and the shadows that all this casts on itself.
#pragma once

#include <cstdint>

#include "calib/model/rig.hpp"
#include "pipeline/types/map.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {

struct ToothSteps {
  Map<double> depth_mm;         ///< valid everywhere, inside 40 … 56 mm
  Map<double> light;            ///< 0 in shadow, in dark gaps and around the patches
  Map<double> contrast;         ///< modulation / mean light, 0.1 … 0.8
  Map<std::uint8_t> near_jump;  ///< within 5 px of a jump of depth

  /// Options of a burst of it, shot and read noise of the rig's sensor; the maps must outlive them.
  [[nodiscard]] SceneOptions options(std::uint64_t noise_seed) const;
};

inline constexpr int kJumpBand_px = 5;

/// Needs at least 200 x 160 px.
[[nodiscard]] ToothSteps make_tooth_steps(const calib::Rig& rig, std::uint64_t seed);

}  // namespace enamel::test
