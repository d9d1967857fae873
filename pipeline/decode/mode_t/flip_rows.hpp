// The loops of flip_blur.hpp over one row. Private to pipeline/decode.
#pragma once

#include "pipeline/decode/mode_t/closure_rows.hpp"

namespace enamel::pipeline {

/// layout: what rounds the kink, B, B sigma_phi^2 and the number of pixels.
inline constexpr std::size_t kFlipSums = 4;

/// Adds one image row to kFlipSums rows of per-column sums: of pixels within flip_full_rad of a flip.
void add_flip_row(const PhaseMaps& m, const RowErrors& e, std::size_t at, std::size_t width, float* sums);

/// Blur of a row's pixels, and from how many of its sigmas off a flip frame 3 is used and counts fully.
struct FlipRow {
  const float *sigma_rad, *motion_rad;  ///< motion per frame interval
  float drop_sigmas, full_sigmas;
};
void rejoin_flip_row(const FlipRow& row, const NoiseModel& noise, std::size_t at, std::size_t width, PhaseMaps& maps,
                     Map<float>& weight);

}  // namespace enamel::pipeline
