// Step 0 on single pictures: dark frames subtracted, flat field divided, noise by photon transfer. All pictures of a
// set share these corrections, so that their own noise would not average out over frames: pixel by pixel only what
// stands out of the noise is taken (k = (variance - noise) / variance of the pattern), the rest as its mean or smooth
// part.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/target/pixel_noise.hpp"
#include "pipeline/types/map.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

struct FrameCorrection {
  Map<float> dark;  ///< DN to subtract; empty: there are no dark frames
  Map<float> gain;  ///< factor, mean 1; empty: there is no flat field
  int dark_frames = 0;
  std::optional<PixelNoise> noise;  ///< of one picture, from two dark frames or more and the flat field

  [[nodiscard]] bool is_empty() const noexcept { return dark_frames == 0 && gain.size() == 0; }
  /// (image - dark) * gain, of the size that read_correction was told.
  void apply(Map<float>& image) const;
};

/// The mean of dark frames, their fixed pattern weighted by what it stands out of their noise, and the variance of one
/// of them over time (empty for a single frame, whose pattern is then not used). All of one size, at least one.
struct DarkFrames {
  Map<float> mean;
  std::optional<double> variance_dn2;
};
[[nodiscard]] DarkFrames average_dark(const std::vector<Map<float>>& frames);

/// Photon transfer at one point: variance of `flat` (dark subtracted) by second differences along the rows, which are
/// free of any shading, over its signal. `floor_dn2`: variance of one dark frame.
[[nodiscard]] PixelNoise photon_transfer(const Map<float>& flat, double floor_dn2);

/// Factor that makes `flat` (dark subtracted) even: its smooth part (Gaussian, sigma 8 px), and pixel by pixel what
/// stands out of `noise`. Clamped to 1/4…4: a dead pixel stays dead instead of becoming infinite.
[[nodiscard]] Map<float> flat_gain(const Map<float>& flat, const PixelNoise& noise);

/// From DIR/dark_<n>.png and DIR/flat.png, taken with the averaging of the poses; `rig_noise`: what rig.json states of
/// one picture. Errors: kImageInvalid (damaged, other size); kCalibrationFolder when flat.png is saturated or dark.
[[nodiscard]] Result<FrameCorrection> read_correction(const std::string& folder, int width, int height,
                                                      double saturation_dn, std::optional<PixelNoise> rig_noise);

}  // namespace enamel::calib
