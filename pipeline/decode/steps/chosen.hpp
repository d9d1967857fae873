// Numbers of the steps that no law gives; limits of the gates stand in decode_gates.hpp. Private to pipeline/decode.
#pragma once

#include <cstdint>

namespace enamel::pipeline {

/// Of a frame's spread over its noise: a frame below the first shows no picture where another above the second shows
/// one. chosen: by judgement. What varies by its noise alone has 1.
inline constexpr double kBlankSigmas = 2, kPictureSigmas = 6;
/// On either side of a jump. chosen: on 50 rows of teeth (docs/notes/decode-attempts.md, orders). One that blur mixes,
/// one that the code may be off by.
inline constexpr std::int32_t kMixed_px = 2;
/// Segments whose code is another one, in a region that is judged by it. chosen: by judgement. Two are a glint.
inline constexpr std::size_t kFewestLiars = 3;

}  // namespace enamel::pipeline
