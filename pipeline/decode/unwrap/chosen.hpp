// Numbers of links, flood, segments and labelling that no law gives; what is told when a decoder is made stands in
// LinkConfig, OrderConfig and CutConfig. Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <cstdint>

namespace enamel::pipeline {

/// Of a pixel beside a cut that still sees its own surface only (links.cpp): turn of its phase against the two behind
/// it, share of the modulation of the one behind. chosen: by judgement. A fifth of the light from the other side turns
/// the phase by up to 0.2 rad or takes as much modulation.
inline constexpr float kMostInlandTurn_rad = 0.3F;
inline constexpr float kLeastInlandModulation = 0.85F;
/// Pixels from one that is half lit to one that lights it. chosen: by judgement, beyond the pixel that blur mixes.
inline constexpr std::ptrdiff_t kHalfLitStep_px = 2;

/// Of the flood's weights. chosen: by judgement. Half a good pixel's: single pixels come last, 128 good ones first.
inline constexpr int kWeightPerBucket = 16;

/// Of a step of the phase. chosen: by judgement. Rad; ripple of the three-frame phase.
inline constexpr float kLeastStep = 0.1F;
/// Of a step of the modulation. chosen: by judgement. Ripple of motion, 0.1 rad a frame, makes half of it.
inline constexpr float kLeastShade = 0.2F;
/// chosen: by judgement. 4.2 sigma of the step, which is sqrt(5) sigma of a mean: 1.5, 1.5, 0.5 and 0.5 of four.
inline constexpr float kShadeSigmas = 9.5F;
/// Rows above and below, where the picture has them, that the modulation's mean is taken over. chosen: by judgement.
inline constexpr int kShadeReach_px = 2;

/// Of a gap, in fringes: how far the columns may go back over it, by noise; how far on over a shadow, whose ends lose
/// pixels to blur. chosen: by judgement.
inline constexpr float kGapBack = 0.08F, kGapOn = 0.22F;
/// That make a gap a shadow. chosen: by judgement.
inline constexpr int kDarkGap_px = 2;

/// Orders beyond the depth range that a surface is followed. chosen: by judgement; mode M's code ratio is made for it
/// (docs/adr/0007-mode-m-becomes-the-default.md).
inline constexpr std::int32_t kBeyond = 2;
/// Columns that neighbours of two rows share at least. More than the one pixel that blur mixes. chosen: on 60 rows of
/// teeth (docs/notes/decode-attempts.md, orders).
inline constexpr std::int32_t kBroad_px = 2;
/// Of a segment's columns. chosen: by judgement. Blur and noise may have taken them from its neighbour.
inline constexpr float kLitEnds_rad = 0.2F;

}  // namespace enamel::pipeline
