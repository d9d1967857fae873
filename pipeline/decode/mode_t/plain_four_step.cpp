#include "pipeline/decode/mode_t/four_step_memory.hpp"

namespace enamel::pipeline {

void PlainFourStep::unwrap(PhaseMaps& phase, Work& work, Regions& regions) const {
  unwrap_by_least_cuts(phase, geometry_.carrier, config_.cuts, memory_of(work).cuts, regions.flood);
  for (std::size_t i = 0; i < phase.reject.size(); ++i)
    if (phase.reject[i] != PixelReject::kNone) regions.flood.component[i] = -1;
}

}  // namespace enamel::pipeline
