#include "calib/target/edge_spread.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace enamel::calib {
namespace {

constexpr double kNarrow = 1e-3;    // narrower boxes are none: the difference quotient would lose its digits
constexpr double kSharp_px = 1e-6;  // of the Gaussian inside kPixelThenTaps: none
constexpr int kMaxTaps = 7;
constexpr double kTapReach = 4;  // sigmas

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

/// No blur at all: most taps lie wholly on one side.
EdgeSpread sharp_edge(double d, double a, double b) {
  constexpr double kHalfDiagonal_px = 0.7072;
  if (d > kHalfDiagonal_px) return {1, 0, 0};
  if (d < -kHalfDiagonal_px) return {0, 0, 0};
  return through_boxes(d, a, b, kSharp_px);
}

/// Samples of a Gaussian at whole pixels, normalised, and their derivative with respect to sigma.
struct Taps {
  int reach = 0;
  std::array<double, 2 * kMaxTaps + 1> weight{}, by_sigma{};
};

Taps taps_of(double sigma) {
  Taps taps;
  taps.reach = std::clamp(static_cast<int>(kTapReach * sigma), 1, kMaxTaps);
  double sum = 0, second = 0;
  for (int k = -taps.reach; k <= taps.reach; ++k) {
    const double w = std::exp(-0.5 * k * k / (sigma * sigma));
    taps.weight[static_cast<std::size_t>(k + taps.reach)] = w;
    sum += w;
    second += w * k * k;
  }
  second /= sum;
  for (int k = -taps.reach; k <= taps.reach; ++k) {
    const auto i = static_cast<std::size_t>(k + taps.reach);
    taps.weight[i] /= sum;
    taps.by_sigma[i] = taps.weight[i] * (k * k - second) / (sigma * sigma * sigma);
  }
  return taps;
}

}  // namespace

EdgeSpread edge_spread(EdgeModel model, double distance_px, const Eigen::Vector2d& normal, double blur_px,
                       double curvature_per_px) {
  const double nx = std::abs(normal.x()), ny = std::abs(normal.y());
  const double a = std::max(nx, ny), b = std::min(nx, ny);
  const double reach_px = 0.75 + 6 * blur_px;  // half the pixel's diagonal and the Gaussian's tail
  if (distance_px > reach_px) return {1, 0, 0};
  if (distance_px < -reach_px) return {0, 0, 0};
  // A place t along the edge lies curvature t²/2 farther out; the mean of t² is 1/12 over the pixel, blur² in the lens.
  const double bend = 0.5 * curvature_per_px;
  const double within_pixel = distance_px - bend / 12;
  if (model == EdgeModel::kLensThenPixel) return through_boxes(within_pixel - bend * blur_px * blur_px, a, b, blur_px);
  const Taps taps = taps_of(blur_px);
  EdgeSpread out;
  for (int j = -taps.reach; j <= taps.reach; ++j) {
    for (int i = -taps.reach; i <= taps.reach; ++i) {
      const auto iu = static_cast<std::size_t>(i + taps.reach), iv = static_cast<std::size_t>(j + taps.reach);
      const double across = i * normal.x() + j * normal.y(), along = j * normal.x() - i * normal.y();
      const EdgeSpread one = sharp_edge(within_pixel - across - bend * along * along, a, b);
      out.cover += taps.weight[iu] * taps.weight[iv] * one.cover;
      out.by_distance += taps.weight[iu] * taps.weight[iv] * one.by_distance;
      out.by_blur += (taps.by_sigma[iu] * taps.weight[iv] + taps.weight[iu] * taps.by_sigma[iv]) * one.cover;
    }
  }
  return out;
}

}  // namespace enamel::calib
