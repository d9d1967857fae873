// The loops of burst_gates.hpp over one row. Private to algo/decode.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pipeline/algo/phase/closure_rows.hpp"

namespace enamel::algo {

struct ClosureCount {
  std::uint32_t seen = 0, fits = 0;
};
/// Residuals of at most tolerance * B + sigmas * sigma(A) fit.
[[nodiscard]] ClosureCount count_closure_row(const PhaseMaps& maps, const NoiseModel& noise, float tolerance,
                                             float sigmas, std::size_t at, std::size_t width);

inline constexpr std::size_t kFramePairs = 6;  ///< 01 02 03 12 13 23

struct RepeatCount {
  std::uint32_t seen = 0;
  std::array<std::uint32_t, kFramePairs> same{};
};
/// frames: the row in each; two are the same at a pixel when they differ by at most `sigmas` of one frame.
[[nodiscard]] RepeatCount count_repeats_row(const std::array<const float*, 4>& frames, const PhaseMaps& maps,
                                            const NoiseModel& noise, float sigmas, std::size_t at, std::size_t width);

inline constexpr std::size_t kOddSums = 4;  ///< (S + C) rest, (S + C)^2 where b = +1; rest, B where b = -1

/// Adds the row to sums[k * width + u].
void add_odd_row(const PhaseMaps& maps, const RowErrors& errors, std::size_t at, std::size_t width, float* sums);

}  // namespace enamel::algo
