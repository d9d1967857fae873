// The image of one disc, integrated without the fit's own formulas, and the bound of what its pixels can tell.
#pragma once

#include "calib/target/disc_fit.hpp"
#include "calib/target/pixel_noise.hpp"
#include "pipeline/types/map.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::test {

/// Of the mean of 16 frames, EMVA line of a 10 000 e sensor.
inline constexpr calib::PixelNoise kDiscNoise{0.09, 0.0016};

/// Levels 25 and 140 DN. Coverage of each pixel by an ellipse, integrated exactly along u and over 64 lines along v,
/// then blurred by a normalised Gaussian kernel.
[[nodiscard]] Map<float> disc_image(const calib::Ellipse& e, double blur_px, int side);

/// The image with normal noise of kDiscNoise.
[[nodiscard]] Map<float> noisy(Map<float> image, Rng& rng);

/// Cramér–Rao bound of the centre along u: unknown are centre, shape, blur, the two levels and the light's gradient.
/// Derivatives of the rendered image by central differences, so that the bound does not come from the fit's own model.
[[nodiscard]] double bound_px(const calib::Ellipse& e, double blur_px, int side);

}  // namespace enamel::test
