// Mode M's four frames to phase. With frames I0, I2, I3 = A + B cos(phi + 2 pi j/3), j = 0, 1, 2, and the code frame
// I1:
//   A = (I0+I2+I3)/3,  C = (2 I0-I2-I3)/3 = B cos(phi),  S = (I3-I2)/sqrt(3) = B sin(phi),  D = I1 - A
// (docs/decode.md §2). sigma = sqrt(2/3) sigma_n/B where noise is the same in all frames; here it is
// propagated frame by frame.
#pragma once

#include <span>

#include "pipeline/decode/phase/cell_span.hpp"
#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

/// Three-step solution and the same physical mask as compute_phase, from frames 0, 2 and 3; code_dn is NaN where frame
/// 1 is saturated. view must be consistent and of the maps' size. Three frames for three unknowns have no closure:
/// motion in the burst is not seen here (micro_refit.hpp sees it by the code frame). A phase that moves by eps a frame
/// interval comes out late by eps/6 (the three frames' mean time) with a ripple of 0.88 eps at twice the fringe
/// frequency (docs/decode.md §5; frame times -1.5, 0.5, 1.5).
void compute_micro_phase(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps);

/// a1 of the phase error a1 sin 3phi that a second harmonic B2 makes in three steps (a1 = -B2/B), self-calibrated: true
/// phase is spread evenly over whole fringes, so a1 = -(2/3)<cos 3phi>. Only pairs of `whole` spans that make a
/// whole fringe are counted, because over half of one a slanted surface would bias the mean. Standard error
/// (2/3)/sqrt(2 N) at worst, for phases at random; 0 from fewer than 5000 pixels. Good for the residue that a
/// projector's look-up table leaves (B2 of a few per cent; first order, what remains is about a1^2); a raw gamma needs
/// the table. Above 0.2 it is no residue: 0.
struct ThirdHarmonic {
  float a1_rad = 0;
  double pixels = 0;
};
[[nodiscard]] ThirdHarmonic estimate_third_harmonic(std::span<const CellSpan> spans, const PhaseMaps& maps);

/// layout: in a map of wrap counts: of a surface whose order is unknown; of none.
inline constexpr std::int16_t kUnplacedWraps = -1000, kNoWraps = -2000;

/// Phi = phase_rad + 2 pi wraps in the spans, kUnplacedWraps in those of unknown order, kNoWraps elsewhere.
void place_spans(std::span<const CellSpan> spans, std::span<const CellSpan> unplaced, int width, int height,
                 Map<std::int16_t>& wraps);

/// Subtracts a1 sin 3phi from phase_rad where there is a surface. Phases may leave [-pi, pi) a little.
void correct_third_harmonic(const Map<std::int16_t>& wraps, float a1_rad, PhaseMaps& maps);

}  // namespace enamel::pipeline
