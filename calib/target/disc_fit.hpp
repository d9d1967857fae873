// The image of a disc fitted to pixels: an ellipse of two levels under a linear illumination, blurred by a Gaussian.
// Its centre is that of the ellipse, not the image of the disc's centre (that correction needs the pose:
// calib/solve/disc_bias.hpp). Pixel centres at integers. Pure functions, thread-safe.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/target/disc_cover.hpp"
#include "calib/target/ellipse.hpp"
#include "calib/target/pixel_noise.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::calib {

struct DiscFit {
  Ellipse ellipse;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre, px²; scaled by the misfit
  double blur_px = 0;                                    ///< Gaussian sigma of the edge, the pixel's square apart
  double ground_dn = 0, step_dn = 0;                     ///< level outside; inside minus outside
  double misfit = 0;                                     ///< chi² / degrees of freedom
  double residual_share = 0;                             ///< rms residual over the step: the shape of what is no disc
};

/// Starting from `start` (e.g. grey moments); `reach_px` = how far outside the contour pixels may be used, below half
/// the gap to a neighbour; pixels beyond the image are done without as long as 8 px of ground are left all around.
/// `image` is above black, DN. Empty: the disc leaves the image, has no contrast, or the fit does not converge.
[[nodiscard]] std::optional<DiscFit> fit_disc(const Map<float>& image, const PixelNoise& noise, const Ellipse& start,
                                              double reach_px, EdgeModel edges);

/// Ellipse with the grey-level area moments of the disc around `seed` (soft mask between the two levels). Empty as
/// above.
[[nodiscard]] std::optional<Ellipse> disc_moments(const Map<float>& image, const Ellipse& seed, double reach_px);

}  // namespace enamel::calib
