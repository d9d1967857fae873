// The loops of closure_gates.hpp over one row. Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pipeline/decode/mode_t/closure_rows.hpp"

namespace enamel::pipeline {

struct ClosureCount {
  std::uint32_t seen = 0, fits = 0;
};
/// Residuals of at most tolerance * B + sigmas * sigma(A) fit.
[[nodiscard]] ClosureCount count_closure_row(const PhaseMaps& maps, const NoiseModel& noise, float tolerance,
                                             float sigmas, std::size_t at, std::size_t width);

/// layout: (S + C) rest, (S + C)^2 where b = +1; rest, B where b = -1; rest, A - black where b = +1.
inline constexpr std::size_t kOddSums = 6;

/// Adds the row to sums[k * width + u].
void add_odd_row(const PhaseMaps& maps, const RowErrors& errors, std::size_t at, std::size_t width, float* sums);

}  // namespace enamel::pipeline
