// What a workspace holds: the maps and lists between the steps of BurstDecoder. Private to algo/decode.
#pragma once

#include <vector>

#include "pipeline/algo/decode/burst_decoder.hpp"
#include "pipeline/algo/decode/likely_turns.hpp"
#include "pipeline/algo/phase/saturated.hpp"
#include "pipeline/algo/unwrap/cells.hpp"
#include "pipeline/algo/unwrap/code_steps.hpp"
#include "pipeline/algo/unwrap/flood.hpp"
#include "pipeline/algo/unwrap/least_cuts.hpp"
#include "pipeline/algo/unwrap/micro_evidence.hpp"
#include "pipeline/algo/unwrap/polarity_evidence.hpp"

namespace enamel::algo {

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

}  // namespace enamel::algo
