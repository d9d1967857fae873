// The image of a disc fitted to pixels: an ellipse of two levels under a linear illumination, blurred by a Gaussian.
// Its centre is that of the ellipse, not the image of the disc's centre (that correction needs the pose:
// calib/solve/disc_bias.hpp). Pixel centres at integers. Pure functions, thread-safe.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/target/edge_spread.hpp"
#include "calib/target/pixel_noise.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::calib {

/// Points q = p - centre with q' shape q = 1 lie on the contour; shape in 1/px².
struct Ellipse {
  Eigen::Vector2d centre{0, 0};
  Eigen::Matrix2d shape = Eigen::Matrix2d::Identity();

  /// sqrt(q' shape q): below 1 inside.
  [[nodiscard]] double radius_at(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d q = p - centre;
    return std::sqrt(q.dot(shape * q));
  }
  /// Half axes, the longer one first, px.
  [[nodiscard]] Eigen::Vector2d half_axes() const;
};

struct DiscFit {
  Ellipse ellipse;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre, px²; scaled by the misfit
  double blur_px = 0;                                    ///< Gaussian sigma of the edge, the pixel's square apart
  double ground_dn = 0, step_dn = 0;                     ///< level outside; inside minus outside
  double misfit = 0;                                     ///< chi² / degrees of freedom
  double residual_share = 0;                             ///< rms residual over the step: the shape of what is no disc
};

/// Starting from `start` (e.g. grey moments); `reach_px` = how far outside the contour pixels may be used, below half
/// the gap to a neighbour. `image` is above black, DN. Empty: the disc leaves the image, has no contrast, or the fit
/// does not converge.
[[nodiscard]] std::optional<DiscFit> fit_disc(const Map<float>& image, const PixelNoise& noise, const Ellipse& start,
                                              double reach_px, EdgeModel edges);

/// Ellipse with the grey-level area moments of the disc around `seed` (soft mask between the two levels). Empty as
/// above.
[[nodiscard]] std::optional<Ellipse> disc_moments(const Map<float>& image, const Ellipse& seed, double reach_px);

}  // namespace enamel::calib
