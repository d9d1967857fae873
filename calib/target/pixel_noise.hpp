// Noise of a pixel as a straight line over its signal: the photon transfer curve (EMVA 1288).
#pragma once

namespace enamel::calib {

/// Variance of a pixel with signal I (DN above black): floor_dn2 + slope_dn * max(I, 0).
struct PixelNoise {
  double floor_dn2 = 1.0;
  double slope_dn = 0.0;

  [[nodiscard]] double variance(double signal_dn) const noexcept {
    return floor_dn2 + slope_dn * (signal_dn > 0 ? signal_dn : 0.0);
  }
  /// Noise of the mean of `frames` independent frames of this noise.
  [[nodiscard]] PixelNoise of_mean(int frames) const noexcept { return {floor_dn2 / frames, slope_dn / frames}; }
};

}  // namespace enamel::calib
