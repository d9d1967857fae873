// Rows of micro_refit.hpp, compiled per instruction set. Private to algo/phase.
#pragma once

#include <cstddef>

#include "pipeline/algo/phase/micro_refit.hpp"

namespace enamel::algo {

inline constexpr float kCodeTime = -0.5F;  ///< of slot 1, frame intervals after mid-burst

/// What a row of the image needs beside its maps, all from its first pixel on.
struct CodeRow {
  const float* order_cos;  ///< of the angle by which the pixel's order turns the code; both 0 outside all spans
  const float* order_sin;
  const float* motion_rad;
  const float* gain;
  const float* light;              ///< dA/A per frame interval
  const float* motion_change_rad;  ///< of eps per frame interval
  const float* light_change;       ///< d2A/A
  float inverse_ratio = 0;         ///< 1/L
  float harmonic = 0;              ///< B2/B
  float black_dn = 0;
};

inline constexpr std::size_t kRefitSums = 5;  ///< gg, gm, mm, gR, mR with the slopes g = dR/dgain, m = dR/deps

/// Adds the row's normal equations to sums[k * width + u], weighted by 1/variance of R.
void add_refit_row(const PhaseMaps& maps, const CodeRow& row, const NoiseModel& noise, float max_residual,
                   std::size_t at, std::size_t width, float* sums);

/// R of a row's pixels, and by how much it falls per unit of motion, of light and of gain. NaN without code.
struct ResidualRow {
  float *residual, *by_motion, *by_light, *by_gain;
};
void code_residual_row(const PhaseMaps& maps, const CodeRow& row, std::size_t at, std::size_t width,
                       const ResidualRow& out);

/// Unknowns of the odd frame: phase of the code frame alone, skew of the other three, and beside them motion, light and
/// gain as far as they differ from what `row` says.
inline constexpr std::size_t kOddColumns = 5;
inline constexpr std::size_t kMicroOddSums = kOddColumns * (kOddColumns + 3) / 2 + 2;

/// Adds the row's normal equations to sums[k * width + u]: for each unknown i its products with i, i + 1, ... and then
/// with the residual, weighted by 1/variance of R; last, pixels with a code and those of them whose residual counts.
void add_micro_odd_row(const PhaseMaps& maps, const CodeRow& row, const NoiseModel& noise, float max_residual,
                       std::size_t at, std::size_t width, float* sums);

/// Phase and mean light of a row as they were at mid-burst; `maps` stays.
void mid_burst_row(const PhaseMaps& maps, const CodeRow& row, std::size_t at, std::size_t width, float* phase_rad,
                   float* mean_dn);

void undo_motion_row(const CodeRow& row, std::size_t at, std::size_t width, PhaseMaps& maps);

/// missed: by how many sigmas the code was off its prediction, squared; 0 outside all spans, NaN without code.
void join_code_row(const CodeRow& row, const NoiseModel& noise, float outlier_sigmas, std::size_t at, std::size_t width,
                   PhaseMaps& maps, float* missed);

}  // namespace enamel::algo
