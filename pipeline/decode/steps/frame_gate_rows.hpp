// The loops of frame_gates.hpp over one row. Private to pipeline/decode.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

inline constexpr std::size_t kFramePairs = 6;  ///< layout: 01 02 03 12 13 23

struct RepeatCount {
  std::uint32_t seen = 0;
  std::array<std::uint32_t, kFramePairs> same{};
};
/// frames: the row in each; two are the same at a pixel when they differ by at most `sigmas` of one frame.
[[nodiscard]] RepeatCount count_repeats_row(const std::array<const float*, 4>& frames, const PhaseMaps& maps,
                                            const NoiseModel& noise, float sigmas, std::size_t at, std::size_t width);

/// Pairs of pixels in a row that are so far apart, of an image so wide.
struct RowPairs {
  std::size_t width = 0, apart = 1;
};
/// Adds what each pixel of the row that begins at `at` and the other one of its pair say of the direction in which
/// phase grows: as the carrier (of the whole image) does, by as much as noise leaves of a sign; and the square of that.
/// sums: two arrays of `width`.
void add_directions_row(const PhaseMaps& maps, const float* carrier_rad, std::size_t at, RowPairs pairs, float* sums);

}  // namespace enamel::pipeline
