// Jumps of whole fringes that the phase does not show but mode M's code does, pixel by pixel. A phase step makes such a
// jump likely and cuts a segment (cells.hpp); where the phase runs on smoothly, a segment would mix both sides, and
// the labelling would have to be talked into a jump by a single segment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/decode/mode_m/code_sum_rows.hpp"
#include "pipeline/decode/mode_m/micro_code.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/unwrap/flood.hpp"

namespace enamel::pipeline {

struct CodeSteps {
  Map<std::uint8_t> cut;  ///< 1: the code jumps between the pixel and its left neighbour

  struct Work {
    CodeSumRow sums;
    StepWindows windows;
    std::vector<std::size_t> columns;  ///< of the candidates
    StepCandidates candidates;
    std::vector<float> misfit;
    std::vector<std::uint8_t> asked;
  } work;
};

/// Fits z (micro_evidence.hpp) to four pixels left and four right of each border, the two pixels beside it left out
/// (blur), once with the same order on both sides and once with d orders between, |d| <= 3. A cut is where the jump is
/// the better explanation by `cost` (negative log likelihood) and fits best among the borders around.
void find_code_steps(const PhaseMaps& phase, const NoiseModel& noise, const MicroCode& code, const FloodMaps& flood,
                     float cost, CodeSteps& out);

}  // namespace enamel::pipeline
