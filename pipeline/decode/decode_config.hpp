// All that a decoder is told. What the pattern modes share comes first; each mode and each gate owns its own.
#pragma once

#include "pipeline/decode/mode_m/micro_mode.hpp"
#include "pipeline/decode/mode_t/four_step_mode.hpp"
#include "pipeline/decode/steps/common_config.hpp"

namespace enamel::pipeline {

struct DecodeConfig : CommonConfig {
  FourStepConfig four_step;  ///< mode T, single-marker and plain sets
  MicroConfig micro;         ///< mode M
};

}  // namespace enamel::pipeline
