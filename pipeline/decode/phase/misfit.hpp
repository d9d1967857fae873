// What the frames of a moving burst still contradict each other by when all that is known of motion, light and the
// projector is taken off. Along grooves and sharp edges that pass by, light and slope change within fewer pixels than
// the motion is known at; noise alone explains their residuals no longer, and a sigma from noise alone would be
// believed. The share beyond noise goes into sigma:
//   sigma_phi^2 = sigma_noise^2 + c^2 (<r^2> - var r) / B^2          r: residual, over cells of the image
// c: phase error over r/B, rms over a fringe, for a change of light that is not known (of motion less than that):
//   mode T, r = closure residual of four frames: 0.38 to 0.50        mode M, r = code frame less its prediction: 0.68
// Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/decode/phase/chosen.hpp"
#include "pipeline/decode/phase/grid_rows.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// derived: the largest c of each mode above, rounded up.
inline constexpr float kPhaseOfClosure = 0.5F, kPhaseOfCode = 0.7F;

/// Of a row's pixels: r^2 over its variance by noise, and that variance over B^2; 0 where a pixel says nothing.
struct MisfitRow {
  const float *squares, *noise;
};

/// One burst's; keeps its memory between bursts. Not thread-safe.
class Misfit {
 public:
  void start(int width, int height);
  /// Every row once, in order. NaN says nothing, too.
  void take_row(int v, const MisfitRow& row);
  /// Adds what exceeds noise to sigma_rad. phase_of_residual: c.
  void add_to(Map<float>& sigma_rad, float phase_of_residual);

 private:
  enum Sum : std::size_t { kSquares, kNoise, kPixels, kSums };

  void finish_cells();
  [[nodiscard]] static float excess(const float* cell);

  int width_ = 0, height_ = 0;
  std::vector<float> column_sums_;  ///< kSums rows of a value a pixel, of the row of cells begun
  std::vector<float> cells_;        ///< kSums values each
  std::vector<float> variance_;     ///< phase variance beyond noise, rad^2, of each cell
};

}  // namespace enamel::pipeline
