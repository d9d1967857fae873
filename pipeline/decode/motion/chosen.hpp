// Numbers of the motion fit that no law gives; what is told when a decoder is made stands in RigidMotionConfig. Private
// to pipeline/decode.
#pragma once

namespace enamel::pipeline {

/// Pixels of the images from a node to the end of its window (motion_images.hpp). chosen: by judgement. Half a fringe
/// in all.
inline constexpr int kReach = 3;
/// The same of the finer nodes. chosen: on the rendered sweep, in mode T; in mode M a flank in grazing light lost by it
/// (docs/notes/decode-attempts.md, motion).
inline constexpr int kDetailReach = 2;

/// Least determinant of a node's 2x2 normal equations. chosen: by judgement. About a quarter of a full window's, and a
/// fortieth of one of the finer nodes.
inline constexpr float kMinNodeDet = 4000, kMinDetailDet = 4000;
/// chosen: by judgement. Of the incidence; slopes of steeper surface are known too badly to judge the motion by.
inline constexpr float kMinNodeCosine = 0.6F;
/// chosen: by judgement. Of the light's incidence; beyond, slopes are known too badly to tell it.
inline constexpr float kMinLitCosine = 0.2F;
/// chosen: by judgement. Of light, per frame interval; more is no surface sliding by.
inline constexpr float kMostGrowth = 0.3F;
/// Sigma of a block's eps beyond which that block tells nothing. chosen: by judgement.
inline constexpr float kInformed_rad = 0.005F;
/// chosen: by judgement. Each leaves out what the round before could not explain.
inline constexpr int kMotionRounds = 3;

}  // namespace enamel::pipeline
