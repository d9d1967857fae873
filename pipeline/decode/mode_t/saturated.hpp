// Pixels of four-step modes with one saturated phase frame, solved from the other three (three_frames.hpp), frame 3 now
// among them, as if its polarity b were +1. Where b = -1, frame 3 repeats frame 1. Without frame 1 both would be
// saturated, so b = +1 is certain. Without frame 0 or 2 two pictures are left for three unknowns: S comes out 0 and the
// phase stays at the crest, 0 or pi, near enough for unwrapping to cross the spot. Such pixels are sorted out again
// once the cells and their polarity are known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/decode/mode_t/cell_signs.hpp"
#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/mode_t/polarity.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/unwrap/links.hpp"

namespace enamel::pipeline {

struct SaturatedPixel {
  std::size_t index = 0;
  std::uint8_t missing = 0;  ///< the saturated frame, 0 … 2
};

/// After compute_phase: solves every kSaturated pixel that has but one saturated frame and passes the other gates of
/// the mask; its reject becomes kNone, its code_dn S where b = +1 is certain, else NaN. `out` lists them in row order.
/// view: that of compute_phase.
void solve_saturated(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps,
                     std::vector<SaturatedPixel>& out);

/// Before reject_edges: rejects (kSaturated) those of the pixels that are cut off from a valid neighbour. Their own
/// phase is the likelier one to be wrong, and must not cost the neighbour's.
void reject_parted(const std::vector<SaturatedPixel>& pixels, LinkMaps& links, Map<PixelReject>& reject);

/// After apply_polarity: rejects (kSaturated) those of the pixels where b = -1, or a flip lies within flip_full_rad;
/// gives the others the sigma of their own three frames.
void sort_out_saturated(const std::vector<SaturatedPixel>& pixels, const CellSigns& signs, const NoiseModel& noise,
                        const PolarityConfig& config, const Map<std::int16_t>& wraps, PhaseMaps& maps);

/// phase_rad of each pixel brought to mid-burst by its own three frames, as closure.hpp does for all others. Call
/// before correct_phase or finish_phase, which take these for others, and put them in place after.
void correct_saturated(const std::vector<SaturatedPixel>& pixels, const PolarityMaps& polarity,
                       const BurstErrors& errors, float black_dn, const PhaseMaps& maps, std::vector<float>& phase_rad);

}  // namespace enamel::pipeline
