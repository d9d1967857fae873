// The loop of phase_moments over one row. Private to pipeline/decode.
#pragma once

#include <array>
#include <cstddef>

#include "pipeline/decode/phase/phase_ripple.hpp"

namespace enamel::pipeline {

/// layout: pixels apart by as many share a sum: the order of adding is fixed.
inline constexpr std::size_t kMomentLanes = 16;

struct MomentLanes {
  using Terms = std::array<std::array<float, kMomentLanes>, kRippleTerms>;
  alignas(32) Terms cosines{}, sines{};
};

/// Adds weight times cos 4m phi and sin 4m phi of the row's pixels; those of weight 0 may hold anything.
void add_moments_row(const PhaseMaps& maps, const float* weight, std::size_t at, std::size_t width, MomentLanes& sums);

}  // namespace enamel::pipeline
