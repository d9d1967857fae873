#include "pipeline/decode/steps/pattern_strategy.hpp"

namespace enamel::pipeline {

void PatternStrategy::unwrap(PhaseMaps& phase, Work&, Regions& regions) const {
  flood(phase.phase_rad, regions.links, regions.flood);
}

}  // namespace enamel::pipeline
