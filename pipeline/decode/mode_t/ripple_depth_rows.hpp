// The loop of ripple_depth.hpp over one row. Private to pipeline/decode.
#pragma once

#include <array>

#include "pipeline/decode/mode_t/ripple_depth.hpp"

namespace enamel::pipeline {

/// In float, as powers of d: the amplitude of a term is its [0] + d [1] + d^2 [2].
struct DepthRippleTerms {
  using Powers = std::array<float, 3>;
  float mean = 0, reach = 0;
  std::array<Powers, kRippleTerms> cosine{}, sine{};
};

[[nodiscard]] DepthRippleTerms float_terms(const DepthRipple& ripple);

void correct_by_depth_row(const DepthRippleTerms& terms, const Map<std::int16_t>& wraps, const float* phase_mid_rad,
                          std::size_t at, std::size_t width, PhaseMaps& maps);

}  // namespace enamel::pipeline
