// Numbers of mode T that no law gives; what is told when a decoder is made stands in the configurations of its steps
// (four_step_mode.hpp). Private to pipeline/decode.
#pragma once

#include <cstdint>

namespace enamel::pipeline {

/// chosen: by judgement. Half fringes of the code: patches of one fringe may be ambiguous, larger ones not.
inline constexpr int kLongestAlike = 2;

/// Of B, by which a fourth frame may be off its prediction. chosen: by judgement. Motion of 0.1 rad a frame with a
/// flip's blur stays below.
inline constexpr float kClosureTolerance = 0.25F;

/// Motions that are tried, to either side of rest; blocks that have one each, and pixels of a block that has a say
/// (fast_motion.hpp). chosen: by judgement.
inline constexpr int kFastSteps = 16;
inline constexpr int kFastBlock_px = 64;
inline constexpr int kFastLeastPixels = 100;

/// chosen: by judgement. Projector blur rounds the kink of frame 3 at a flip by up to this share of B (blur of 1.9 px
/// in a period of 24).
inline constexpr float kBlurError = 0.2F;
/// Of T, beyond which a segment's code is silent. chosen: by judgement. T of +-1 is two of its sigmas from 0 then.
inline constexpr float kFaintVariance = 0.25F;
/// chosen: by judgement. Blur mixes the pixels at a run's end with what lies beyond.
inline constexpr std::int32_t kPolarityEndTrim_px = 3;

/// chosen: by judgement, as ClosureConfig::max_residual. Of B; beyond it the pixel beside a flip sees an edge or a
/// glint.
inline constexpr float kMostFlipResidual = 0.6F;
/// chosen: by judgement. Of |sin phi|; nearer to a flip blur rounds frame 3 of a torn pixel.
inline constexpr float kClearOfFlip = 0.4F;

/// Of full scale, of pixels that are asked for light that changed. chosen: by judgement, below PhaseConfig::saturation.
inline constexpr float kBrightest = 0.95F;

/// Of B, by which frames 1 and 3 differ at most where one repeats the other. chosen: by judgement, twice the quarter
/// radian a frame of a true burst.
inline constexpr float kAlike = 0.5F;

/// Of the ripple's depth (ripple_depth.hpp). chosen: by judgement.
inline constexpr double kDepthReach = 2;            ///< standard deviations of depth
inline constexpr double kLeastDepthSpread_rad = 1;  ///< a surface that spans less has one depth
inline constexpr double kLeastDepthRest = 1e-3;  ///< share of d^4 that P1 and a constant leave: below, d^2 is not new

/// Of frame_errors.hpp. chosen: by judgement, the captured plaster in view (docs/notes/decode-attempts.md, ripple).
inline constexpr int kRobustRounds = 3;       ///< each leaves out what the round before could not explain
inline constexpr double kOutlierSigmas = 3;   ///< ... by so much
inline constexpr double kLeastFilled = 0.75;  ///< of the fringe around a pixel: the mean of less is no fringe's

}  // namespace enamel::pipeline
