// How an edge between two levels shows in square pixels.
#pragma once

#include <Eigen/Core>
#include <array>

namespace enamel::calib {

struct EdgeSpread {
  double cover = 0;        ///< share of the inner level, 0…1
  double by_distance = 0;  ///< d cover / d distance, 1/px
  double by_blur = 0;      ///< d cover / d blur, 1/px
};

/// A square of side `side_px` whose centre lies `distance_px` inside an edge of unit normal `normal`; `blur_px` is the
/// Gaussian's sigma, the square not included; 0: sharp, by_blur is not meant. `curvature_per_px` is that of the edge,
/// positive where the inside is convex: to first order it shifts what is averaged, by the mean height of the arc over
/// the square's middle. Exact for straight edges: the square's shadow along the normal is two boxes of widths side |nx|
/// and side |ny|, a Gaussian through two boxes is a second difference of its second integral.
[[nodiscard]] EdgeSpread edge_spread(double distance_px, const Eigen::Vector2d& normal, double blur_px,
                                     double curvature_per_px = 0, double side_px = 1);

/// Samples of a Gaussian at the whole pixels -reach … reach, normalised, and their derivative with respect to sigma.
inline constexpr int kMaxTaps = 7;
struct GaussianTaps {
  int reach = 0;
  std::array<double, 2 * kMaxTaps + 1> weight{}, by_sigma{};

  explicit GaussianTaps(double sigma_px);
  [[nodiscard]] double weight_at(int offset) const { return weight[static_cast<std::size_t>(offset + reach)]; }
  [[nodiscard]] double slope_at(int offset) const { return by_sigma[static_cast<std::size_t>(offset + reach)]; }
};

}  // namespace enamel::calib
