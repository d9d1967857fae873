// Numbers of triangulation that no law gives; what is told when a decoder is made stands in NormalConfig. Private to
// pipeline/decode.
#pragma once

namespace enamel::pipeline {

/// Of the cubic of 1/z over Phi. chosen: by judgement. Three more than its four unknowns; the cubic then is off the
/// iteration by 0.007 um (docs/bench/decode.md).
inline constexpr int kDepthNodes = 7;
/// Of Phi over the depth range. chosen: by judgement. Less than a twelfth of a fringe in all measures nothing.
inline constexpr double kMinHalfRange_rad = 0.25;
/// chosen: by judgement. The ring of normal_rows.cpp, whose lever arm works against noise, is made for it.
inline constexpr int kNormalReach_px = 3;

}  // namespace enamel::pipeline
