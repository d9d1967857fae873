#include "calib/target/edge_spread.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::calib {
namespace {

constexpr double kNarrow = 1e-3;    // narrower boxes are none: the difference quotient would lose its digits
constexpr double kSharp_px = 1e-6;  // stands for none
constexpr double kTapReach = 4;     // sigmas

/// Integrals of the normal distribution's density at x: 0 density … 2 second integral of the distribution.
struct Integrals {
  double density = 0, once = 0, twice = 0, thrice = 0;
};

Integrals integrals(double x, double sigma) {
  const double z = x / sigma;
  if (z > 8) return {0, 1, x, 0.5 * (x * x + sigma * sigma)};
  if (z < -8) return {};
  const double density = std::exp(-0.5 * z * z) / (sigma * std::sqrt(2 * std::numbers::pi));
  const double distribution = 0.5 * std::erfc(-z / std::numbers::sqrt2);
  const double s2 = sigma * sigma;
  return {density, distribution, x * distribution + s2 * density,
          0.5 * ((x * x + s2) * distribution + x * s2 * density)};
}

/// A Gaussian edge seen through boxes of widths a >= b. Derivatives with respect to sigma follow from the heat
/// equation: d/dsigma of an integral of the density is sigma times its second derivative.
EdgeSpread through_boxes(double d, double a, double b, double sigma) {
  if (b < kNarrow) {
    const Integrals p = integrals(d + a / 2, sigma), m = integrals(d - a / 2, sigma);
    return {(p.twice - m.twice) / a, (p.once - m.once) / a, sigma * (p.density - m.density) / a};
  }
  const double s = (a + b) / 2, t = (a - b) / 2;
  const Integrals i0 = integrals(d + s, sigma), i1 = integrals(d + t, sigma), i2 = integrals(d - t, sigma),
                  i3 = integrals(d - s, sigma);
  const double ab = a * b;
  return {(i0.thrice - i1.thrice - i2.thrice + i3.thrice) / ab, (i0.twice - i1.twice - i2.twice + i3.twice) / ab,
          sigma * (i0.once - i1.once - i2.once + i3.once) / ab};
}

}  // namespace

EdgeSpread edge_spread(double distance_px, const Eigen::Vector2d& normal, double blur_px, double curvature_per_px,
                       double side_px) {
  const double nx = side_px * std::abs(normal.x()), ny = side_px * std::abs(normal.y());
  const double reach_px = 0.75 * side_px + 6 * blur_px;  // half the square's diagonal and the Gaussian's tail
  if (distance_px > reach_px) return {1, 0, 0};
  if (distance_px < -reach_px) return {0, 0, 0};
  // A place t along the edge lies curvature t²/2 farther out; the mean of t² is side²/12 over the square, blur² in the
  // lens.
  const double bend_px = 0.5 * curvature_per_px * (side_px * side_px / 12 + blur_px * blur_px);
  EdgeSpread edge =
      through_boxes(distance_px - bend_px, std::max(nx, ny), std::min(nx, ny), std::max(blur_px, kSharp_px));
  edge.by_blur -= edge.by_distance * curvature_per_px * blur_px;
  return edge;
}

GaussianTaps::GaussianTaps(double sigma_px) : reach(std::clamp(static_cast<int>(kTapReach * sigma_px), 1, kMaxTaps)) {
  double sum = 0, second = 0;
  for (int k = -reach; k <= reach; ++k) {
    const double w = std::exp(-0.5 * k * k / (sigma_px * sigma_px));
    weight[static_cast<std::size_t>(k + reach)] = w;
    sum += w;
    second += w * k * k;
  }
  second /= sum;
  for (int k = -reach; k <= reach; ++k) {
    const auto i = static_cast<std::size_t>(k + reach);
    weight[i] /= sum;
    by_sigma[i] = weight[i] * (k * k - second) / (sigma_px * sigma_px * sigma_px);
  }
}

}  // namespace enamel::calib
