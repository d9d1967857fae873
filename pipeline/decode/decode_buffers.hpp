// What a workspace holds: the maps and lists between the steps of BurstDecoder. Private to pipeline/decode.
#pragma once

#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/decode/mode_m/code_steps.hpp"
#include "pipeline/decode/mode_m/likely_turns.hpp"
#include "pipeline/decode/mode_m/micro_evidence.hpp"
#include "pipeline/decode/mode_t/polarity_evidence.hpp"
#include "pipeline/decode/mode_t/four_step_view.hpp"
#include "pipeline/decode/mode_t/saturated.hpp"
#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/flood.hpp"
#include "pipeline/decode/unwrap/least_cuts.hpp"

namespace enamel::pipeline {

struct DecodeWorkspace::Buffers {
  PhaseMaps phase;
  LinkMaps links;
  FloodMaps flood;
  LeastCutsWork cuts;  ///< of patterns without a code
  CodeSteps steps;     ///< of mode M
  PieceList pieces;
  PolarityEvidence polarity_evidence;
  MicroEvidence micro_evidence;
  OrderResult orders;
  std::vector<CellSpan> spans;
  std::vector<CellSpan> relative_cells;  ///< of mode M's undecided pieces
  PolarityMaps polarity;
  ClosureFit closure;
  FlipBlur flips;
  FourStepPixels view_pixels;
  RigidMotionWork rigid;
  MotionField field;
  MicroMotion micro_motion;
  CodeStrips strips;                      ///< of mode M
  Misfit misfit;                          ///< of bursts that moved
  TornPixels torn;                        ///< of those of mode T
  LikelyTurns likely;                     ///< of mode M
  PhaseMaps moved;                        ///< of mode M: `phase` as its code frame sees it; sigma and mask are unused
  std::vector<SaturatedPixel> saturated;  ///< solved without their saturated frame
  std::vector<std::size_t> filled;        ///< the same of mode M
  std::vector<float> scratch;
};

[[nodiscard]] std::size_t count_of(const PhaseMaps& maps, PixelReject reason) noexcept;

}  // namespace enamel::pipeline
