#include "pipeline/decode/steps/pattern_strategy.hpp"

#include <cmath>

#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {

int BurstGeometry::fringe_px() const {
  const auto width = static_cast<std::size_t>(rays->width);
  const float* row = rays->phase_mid_rad.data() + static_cast<std::size_t>(rays->height / 2) * width;
  const float rows_rad = std::abs(row[width - 1] - row[0]);
  return rows_rad > 0 ? static_cast<int>(kTwoPiF * static_cast<float>(width - 1) / rows_rad + 0.5F) : 0;
}

void PatternStrategy::unwrap(PhaseMaps& phase, Work&, Regions& regions) const {
  flood(phase.phase_rad, regions.links, regions.flood);
}

}  // namespace enamel::pipeline
