// The loop of phase_moments over one row. Private to algo/phase.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pipeline/algo/phase/phase_ripple.hpp"

namespace enamel::algo {

inline constexpr std::size_t kMomentLanes = 16;  ///< pixels apart by as many share a sum: the order of adding is fixed

struct MomentLanes {
  using Terms = std::array<std::array<float, kMomentLanes>, kRippleTerms>;
  alignas(32) Terms cosines{}, sines{};
};

/// Adds cos 4m phi and sin 4m phi of the row's pixels that are `counted` (1, else 0).
void add_moments_row(const PhaseMaps& maps, const std::uint8_t* counted, std::size_t at, std::size_t width,
                     MomentLanes& sums);

}  // namespace enamel::algo
