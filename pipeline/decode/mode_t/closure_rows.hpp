// The loops of fit_closure and correct_phase over one row. Private to pipeline/decode.
#pragma once

#include <vector>

#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/motion/gathered_runs.hpp"
#include "pipeline/decode/phase/frame_turns.hpp"
#include "pipeline/decode/phase/row_memory.hpp"
#include "protocol/base/staggered.hpp"

namespace enamel::pipeline {

/// layout: x1x1 x1x2 x2x2 x1y x2y x1x1v, with x1 the motion's and x2 the harmonic's column of the residual y and v the
/// variance of one frame there.
inline constexpr std::size_t kClosureSums = 6;

/// Adds one image row to kClosureSums rows of per-column sums: the order of additions is fixed. limit: of |y|/B.
void add_closure_row(const PhaseMaps& m, const PolarityMaps& p, const NoiseModel& noise, std::size_t at,
                     std::size_t width, float limit, float* sums);

/// What shifts the phase of one row's pixels.
struct RowErrors {
  const float *weight = nullptr, *rate = nullptr, *harmonic = nullptr, *light = nullptr, *rate_change = nullptr,
              *light_change = nullptr;
  float black_dn = 0;
  bool steady = false;  ///< light, rate_change and light_change are 0

  [[nodiscard]] PixelChange change(std::size_t u) const { return {rate[u], rate_change[u], light[u], light_change[u]}; }
};

/// The errors of a burst, row by row.
class ErrorRows {
 public:
  ErrorRows(const BurstErrors& errors, float black_dn, int width, GridColumns columns = {})
      : rate_(errors.motion_rad, width, columns),
        harmonic_(errors.harmonic, width, columns),
        light_(errors.light, width, columns),
        rate_change_(errors.motion_change, width, columns),
        light_change_(errors.light_change, width, columns),
        black_dn_(black_dn),
        steady_(errors.light.nodes == nullptr && errors.motion_change.nodes == nullptr &&
                errors.light_change.nodes == nullptr) {}

  /// Valid until the next call.
  [[nodiscard]] RowErrors at(const PolarityMaps& polarity, int v) { return with(&polarity.weight(0, v), v); }
  /// weight: of the columns asked for.
  [[nodiscard]] RowErrors with(const float* weight, int v) {
    return {weight,    rate_.row(v), harmonic_.row(v), light_.row(v), rate_change_.row(v), light_change_.row(v),
            black_dn_, steady_};
  }

 private:
  GridRows rate_, harmonic_, light_, rate_change_, light_change_;
  float black_dn_;
  bool steady_;
};

/// Pixels side by side, as they were measured, and what shifts their phase.
struct PixelRow {
  const float *cosine = nullptr, *sine = nullptr, *code = nullptr, *mean = nullptr, *phase = nullptr;
  RowErrors errors;
};

/// All pixels of the row that begins at `at`.
[[nodiscard]] PixelRow pixel_row(const PhaseMaps& m, const RowErrors& e, std::size_t at);

/// Pixels (2x, 2y) of what a burst shows, brought together: steps within the loops below would cost more.
class SparsePixels {
 public:
  void take(const PhaseMaps& maps, const PolarityMaps& polarity);
  /// Those of image row v, an even one; errors: of their columns.
  [[nodiscard]] PixelRow row(ErrorRows& errors, int v) const;
  [[nodiscard]] std::size_t columns() const noexcept { return columns_; }

 private:
  std::size_t columns_ = 0;
  StaggeredVector<float> cosine_, sine_, code_, mean_, phase_, weight_;
};

/// Errors of such pixels, from those of all columns.
class GatheredErrors {
 public:
  /// weight: theirs. Valid until the next call.
  [[nodiscard]] RowErrors of(const RowErrors& all, const float* weight, const GatheredRuns& runs);

 private:
  RowMemory values_;
};

/// Phase and, unless null, A - black as they were at mid-burst, less the harmonic. phase_rad may be the row's own.
void mid_burst_row(const PixelRow& row, std::size_t count, float* phase_rad, float* light_dn);

/// Phase as above, and what the closure residual of the corrected frames tells Misfit; rejected pixels and those beside
/// a flip, which have three frames only, tell nothing. modulation: B, DN.
struct ClosedRow {
  float *phase_rad, *squares, *noise;
};
void closed_row(const PixelRow& row, const float* modulation, const PixelReject* reject, const NoiseModel& noise,
                std::size_t count, const ClosedRow& out);

/// What frame 3 leaves of the prediction that the other three make under the motion and light given, in DN and with the
/// sign of the closure residual, and by how much it grows per unit of each error. NaN within reach of a flip.
struct LeftRow {
  float *residual, *by_rate, *by_light, *by_harmonic;
};
void left_row(const PixelRow& row, std::size_t count, const LeftRow& out);

}  // namespace enamel::pipeline
