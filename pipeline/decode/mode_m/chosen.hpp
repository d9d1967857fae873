// Numbers of mode M that no law gives; what is told when a decoder is made stands in MicroRefitConfig and the gates of
// micro_mode.hpp. Private to pipeline/decode.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace enamel::pipeline {

/// Least angle between the codes of two orders. chosen: by judgement, above twice the 0.16 by which a phase moving by
/// 0.2 rad a frame turns the code: the nearer of two orders must still be the right one.
inline constexpr double kLeastTurn_rad = 0.35;

/// Of the code frame's modulation to B. chosen: by judgement, within what blur leaves: from 1 without blur down to 0.72
/// where a Gaussian blur leaves 0.4 of B (its share at frequency f (1 + 1/6) is that at f to the power 1.36).
inline constexpr float kCodeGain = 0.9F;
/// Spread of z about kCodeGain exp(2 pi i k/L), each way: that of the gain, and motion of 0.2 rad a frame, which turns
/// z by 0.16. chosen: by judgement.
inline constexpr double kCodeSpread = 0.15;
inline constexpr double kCodeRidge = 1e-2;  ///< z is unknown to within 10 before the segment is seen
/// Lengths that a sound z has. chosen: by judgement.
inline constexpr float kShortestCode = 0.4F, kLongestCode = 1.6F;
/// Of the step to the next order, within which a code agrees. chosen: by judgement, below its half.
inline constexpr float kStepShare = 1.0F / 3;
/// Sigmas of noise that must fit into that share. derived: 0.3 % of a Gaussian lies beyond.
inline constexpr float kStanceSigmas = 3;
/// Of the codes that noise does not blur: if fewer are as sharp, all are asked. chosen: by judgement.
inline constexpr double kKeenShare = 0.1;
/// chosen: by judgement. A few pixels already tell: at a run's end one that blur mixes, one to spare.
inline constexpr std::int32_t kMicroEndTrim_px = 2;

/// Borders of a row are asked whether the code jumps there: pixels left out on either side, and pixels fitted beyond.
/// chosen: by judgement. Blur mixes one pixel.
inline constexpr std::size_t kStepGap_px = 1, kStepWindow_px = 4;

/// Strips along an edge: that it may move from row to row; weight of the rows above and below, for a strip is about as
/// wide ten rows on; width, above which code_steps.hpp finds them. chosen: by judgement; strips as a whole were judged
/// on rows of teeth (docs/notes/decode-attempts.md, orders).
inline constexpr std::int32_t kEdgeDrift_px = 2;
inline constexpr float kEdgeMemory = 0.9F;
inline constexpr std::size_t kMostStrip_px = 8;
/// Log likelihood of one pixel. chosen: by judgement. A third of MicroRefitConfig::strip_evidence: none decides alone.
inline constexpr float kMostDoubt = 4;

/// Of the ends of the depth range. chosen: by judgement. Surfaces run on beyond it.
inline constexpr float kBeyondRange = 0.15F;

/// Of a third harmonic: more is no residue of a look-up table; pixels it is asked of. chosen: by judgement. First order
/// leaves a1^2; the standard error of a1, (2/3)/sqrt(2 n), is 0.007 rad at most.
inline constexpr float kLargestResidue_rad = 0.2F;
inline constexpr double kMinHarmonicPixels = 5000;

/// Of the waveform once orders are known: rows it is asked of; spread of what the first estimate is off by. chosen: by
/// judgement, above the 0.02 that a curved surface adds to it.
inline constexpr int kWaveRowStep = 8;
inline constexpr double kWaveSpread = 0.03;

/// Of an odd frame: side of a block; sigma of its phase of the code frame that is asked; spread of the unknowns, in the
/// order of kOddColumns: phases and light of a frame anywhere, what blocks leave of motion, light, gain and harmonics.
/// chosen: by judgement.
inline constexpr int kOddBlock_px = 64;
inline constexpr double kOddInformed_rad = 0.05;
inline constexpr std::array<double, 9> kOddSpread = {1, 1, 1, 1, 0.3, 0.3, 0.1, 0.1, 0.1};

/// Of pixels with a saturated frame. chosen: by judgement.
inline constexpr float kLargestBend_rad = 1.0F;     ///< of the step across a run against the carrier's
inline constexpr double kLargestOff_rad = 0.5;      ///< of a solution against the straight line across the run
inline constexpr double kLeastAlike = 0.6;          ///< of A and B against those of the neighbours, or the inverse
inline constexpr int kMostIterations = 8;           ///< of Newton's
inline constexpr double kConverged_rad = 1e-5;      ///< far below noise
inline constexpr double kRemadeRounding_dn = 0.01;  ///< of frames made anew from A, C and S

}  // namespace enamel::pipeline
