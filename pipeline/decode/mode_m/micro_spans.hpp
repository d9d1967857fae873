// Rows of a mode M burst with their orders and motion, and sums over blocks of them. Private to pipeline/decode.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/mode_m/micro_refit.hpp"
#include "pipeline/decode/mode_m/micro_refit_rows.hpp"

namespace enamel::pipeline {

/// Of a row of place_spans, as CodeRow has them.
inline void take_wraps(const std::int16_t* wrap_counts, std::vector<float>& out) {
  for (std::size_t u = 0; u < out.size(); ++u) out[u] = static_cast<float>(wrap_counts[u]);
}

/// Rows of a burst's pixels with the motion, light and gain that they are seen under. One caller's; cheapest in order.
class CodeRows {
 public:
  /// wraps: place_spans; null: all pixels are of a surface whose order does not matter.
  CodeRows(const SurfaceMotion& motion, const Grid& gain, float black_dn, const PhaseMaps& maps,
           const Map<std::int16_t>* wraps)
      : maps_(maps),
        wraps_(wraps),
        row_wraps_(static_cast<std::size_t>(maps.phase_rad.width()), kUnplaced),
        rate_(motion.rate_rad, maps.phase_rad.width()),
        gain_(gain, maps.phase_rad.width()),
        light_(motion.light, maps.phase_rad.width()),
        rate_change_(motion.rate_change_rad, maps.phase_rad.width()),
        light_change_(motion.light_change, maps.phase_rad.width()),
        black_dn_(black_dn),
        steady_(motion.light.nodes == nullptr && motion.rate_change_rad.nodes == nullptr &&
                motion.light_change.nodes == nullptr) {}
  CodeRows(const MicroMotion& motion, const PhaseMaps& maps, const Map<std::int16_t>* wraps)
      : CodeRows(motion.everywhere(), motion.gain_grid(), motion.black_dn, maps, wraps) {}

  /// The code frame's wave, for what compares with it; third_rad: a1 of micro_phase.hpp.
  void expect(const MicroCode& code, float third_rad) noexcept {
    inverse_ratio_ = code.inverse_ratio, harmonic_ = -third_rad;
  }

  /// Valid until the next call.
  [[nodiscard]] CodeRow at(int v) {
    if (wraps_ != nullptr) take_wraps(&(*wraps_)(0, v), row_wraps_);
    return {code_pixels(maps_, maps_.phase_rad.index(0, v)),
            row_wraps_.data(),
            rate_.row(v),
            gain_.row(v),
            light_.row(v),
            rate_change_.row(v),
            light_change_.row(v),
            inverse_ratio_,
            harmonic_,
            black_dn_,
            steady_};
  }

 private:
  const PhaseMaps& maps_;
  const Map<std::int16_t>* wraps_;
  std::vector<float> row_wraps_;
  GridRows rate_, gain_, light_, rate_change_, light_change_;
  float inverse_ratio_ = 0, harmonic_ = 0, black_dn_;
  bool steady_;
};

}  // namespace enamel::pipeline
