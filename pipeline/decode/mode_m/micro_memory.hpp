// What mode M remembers between the steps of one burst. Private to pipeline/decode/mode_m.
#pragma once

#include <vector>

#include "pipeline/decode/mode_m/code_steps.hpp"
#include "pipeline/decode/mode_m/code_strips.hpp"
#include "pipeline/decode/mode_m/likely_wraps.hpp"
#include "pipeline/decode/mode_m/micro_evidence.hpp"
#include "pipeline/decode/mode_m/micro_mode.hpp"
#include "pipeline/decode/mode_m/micro_wave.hpp"
#include "pipeline/decode/phase/light_change.hpp"
#include "pipeline/decode/phase/misfit.hpp"

namespace enamel::pipeline {

struct MicroMode::Memory : PatternStrategy::Work {
  CodeSteps steps;
  RawFrames raw;  ///< of a projector that is not linear
  MicroWave wave;
  MicroEvidence evidence;
  LikelyWraps likely;
  PhaseMaps at_code;  ///< the phase as the code frame sees it
  Map<std::int16_t> wraps;
  MicroMotion motion;
  RigidMotionWork rigid;
  MotionField field;
  LightChange light;
  std::vector<CellSpan> relative_cells;  ///< of regions without an order
  CodeStrips strips;
  std::vector<float> join_scratch;
  Misfit misfit;                    ///< of bursts that moved
  std::vector<std::size_t> filled;  ///< solved without their saturated frame
};

}  // namespace enamel::pipeline
