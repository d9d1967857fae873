// What mode T remembers between the steps of one burst. Private to pipeline/decode/mode_t.
#pragma once

#include <vector>

#include "pipeline/decode/mode_t/four_step_mode.hpp"
#include "pipeline/decode/mode_t/four_step_view.hpp"
#include "pipeline/decode/mode_t/four_step_wave.hpp"
#include "pipeline/decode/mode_t/polarity_evidence.hpp"
#include "pipeline/decode/mode_t/saturated.hpp"
#include "pipeline/decode/phase/light_change.hpp"
#include "pipeline/decode/phase/misfit.hpp"
#include "pipeline/decode/unwrap/least_cuts.hpp"

namespace enamel::pipeline {

struct FourStepMode::Memory : PatternStrategy::Work {
  std::vector<SaturatedPixel> saturated;  ///< solved without their saturated frame
  LeastCutsWork cuts;                     ///< of patterns without a code
  RawFrames raw;                          ///< of a projector that is not linear
  PolarityEvidence evidence;
  PolarityMaps polarity;
  ClosureFit closure;
  FourStepPixels pixels;
  RigidMotionWork rigid;
  MotionField field;
  LightChange light;
  FlipBlur flips;
  Misfit misfit;    ///< of bursts that moved
  TornPixels torn;  ///< of these
  std::vector<float> saturated_rad;

  /// What is known of motion, light and harmonic once find_motion is done. Valid while this lives.
  [[nodiscard]] BurstErrors errors(bool moved) const noexcept { return moved ? errors_of(field) : closure.errors(); }
};

}  // namespace enamel::pipeline
