// The loops of fit_closure and correct_phase over one row.
#pragma once

#include "pipeline/algo/phase/closure.hpp"

namespace enamel::algo {

/// x1x1 x1x2 x2x2 x1y x2y n, with x1 the motion's and x2 the harmonic's column of the residual y.
inline constexpr std::size_t kClosureSums = 6;

/// Adds one image row to kClosureSums rows of per-column sums: the order of additions is fixed. limit: of |y|/B.
void add_closure_row(const PhaseMaps& m, const PolarityMaps& p, std::size_t at, std::size_t width, float limit,
                     float* sums);

/// What shifts the phase of one row's pixels.
struct RowErrors {
  const float *weight, *rate, *harmonic, *light;
};

/// The errors of a burst, row by row.
class ErrorRows {
 public:
  ErrorRows(const BurstErrors& errors, int width)
      : rate_(errors.motion_rad, width), harmonic_(errors.harmonic, width), light_(errors.light, width) {}

  /// Valid until the next call.
  [[nodiscard]] RowErrors at(const PolarityMaps& polarity, int v) {
    return {&polarity.weight(0, v), rate_.row(v), harmonic_.row(v), light_.row(v)};
  }

 private:
  GridRows rate_, harmonic_, light_;
};

/// phase[u] -= error (equations of closure.hpp).
void correct_phase_row(const PhaseMaps& m, const RowErrors& e, float black_dn, std::size_t at, std::size_t width,
                       float* phase);

}  // namespace enamel::algo
