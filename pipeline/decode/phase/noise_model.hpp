// Variance of one pixel of one frame: shot noise, read noise, rounding. Units DN.
#pragma once

#include "calib/model/rig.hpp"
#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {

enum class NoiseSource {
  kRig,      ///< the rig's sensor values
  kClosure,  ///< estimated from the burst's own closure residual; black level taken as 0
};

/// var(I) = floor + slope * max(I - black, 0).
struct NoiseModel {
  float floor_dn2 = 1.0F / 12;
  float slope_dn = 0;
  float black_dn = 0;
  float full_scale_dn = 255;
  NoiseSource source = NoiseSource::kRig;

  [[nodiscard]] float variance(float intensity_dn) const noexcept {
    const float signal = intensity_dn - black_dn;
    return floor_dn2 + slope_dn * larger(signal, 0);
  }
};

/// bit_depth: of the frames; the rig's DN are those of its `bits` and scale to it.
[[nodiscard]] NoiseModel noise_from_rig(const calib::NoiseValues& noise, int bit_depth);

/// From the closure residual of well-lit pixels, where the fourth frame is either A + S (residual std 2 sigma) or A - S
/// (std sqrt 2 sigma): median absolute deviations in intensity bins, straight line through them. Motion and a
/// projector's second harmonic widen it: an upper bound.
[[nodiscard]] NoiseModel noise_from_closure(const BurstView& view);

}  // namespace enamel::pipeline
