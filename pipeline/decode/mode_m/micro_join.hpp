// Two steps of micro_refit.hpp row by row. Private to pipeline/decode/mode_m.
#pragma once

#include <vector>

#include "pipeline/decode/mode_m/micro_refit.hpp"

namespace enamel::pipeline {

/// undo_micro_motion, then join_code_frame: the same maps, in half the passes over them. scratch: memory
/// that is kept between bursts.
void undo_motion_and_join(const CodeJoin& in, const MicroRefitConfig& config, PhaseMaps& maps,
                          const CodeJoinChecks& checks, std::vector<float>& scratch);

}  // namespace enamel::pipeline
