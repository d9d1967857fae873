#include "tests/support/disc_image.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace enamel::test {
namespace {

constexpr double kGround_dn = 25, kStep_dn = 115;

}  // namespace

using calib::Ellipse;

Map<float> disc_image(const Ellipse& e, double blur_px, int side) {
  constexpr int kLines = 64;
  Map<double> cover(side, side);
  for (int line = 0; line < side * kLines; ++line) {
    const double y = (line + 0.5) / kLines - 0.5 - e.centre.y();
    // shape(0,0) x² + 2 shape(0,1) x y + shape(1,1) y² = 1
    const double a = e.shape(0, 0), b = e.shape(0, 1) * y, c = e.shape(1, 1) * y * y - 1;
    const double root = b * b - a * c;
    if (root <= 0) continue;
    const double from = e.centre.x() + (-b - std::sqrt(root)) / a, to = e.centre.x() + (-b + std::sqrt(root)) / a;
    for (int u = 0; u < side; ++u)
      cover(u, line / kLines) += std::max(0.0, std::min(to, u + 0.5) - std::max(from, u - 0.5)) / kLines;
  }
  const int reach = static_cast<int>(std::ceil(5 * blur_px));
  std::vector<double> kernel;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) sum += kernel.emplace_back(std::exp(-0.5 * k * k / (blur_px * blur_px)));
  const auto blurred = [&](const Map<double>& in, bool along_v) {
    Map<double> out(side, side);
    for (int v = 0; v < side; ++v)
      for (int u = 0; u < side; ++u) {
        double value = 0;
        for (int k = -reach; k <= reach; ++k) {
          const int x = std::clamp(along_v ? u : u + k, 0, side - 1), y = std::clamp(along_v ? v + k : v, 0, side - 1);
          value += kernel[static_cast<std::size_t>(k + reach)] / sum * in(x, y);
        }
        out(u, v) = value;
      }
    return out;
  };
  const Map<double> soft = blurred(blurred(cover, false), true);
  Map<float> image(side, side);
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<float>(kGround_dn + kStep_dn * soft[i]);
  return image;
}

Map<float> noisy(Map<float> image, Rng& rng) {
  for (float& p : image.pixels())
    p = static_cast<float>(static_cast<double>(p) +
                           std::sqrt(kDiscNoise.variance(static_cast<double>(p))) * rng.normal());
  return image;
}

double bound_px(const Ellipse& e, double blur_px, int side) {
  const Map<float> base = disc_image(e, blur_px, side);
  const auto n = static_cast<Eigen::Index>(base.size());
  Eigen::MatrixXd j(n, 10);
  const auto column = [&](int c, const Map<float>& plus, const Map<float>& minus, double width) {
    for (Eigen::Index i = 0; i < n; ++i)
      j(i, c) = (static_cast<double>(plus[static_cast<std::size_t>(i)]) -
                 static_cast<double>(minus[static_cast<std::size_t>(i)])) /
                width;
  };
  const auto with = [&](auto change, double h) {
    Ellipse a = e;
    change(a, h);
    return disc_image(a, blur_px, side);
  };
  const auto ellipse_column = [&](int c, auto change, double h) {
    column(c, with(change, h), with(change, -h), 2 * h);
  };
  ellipse_column(
      0, [](Ellipse& a, double h) { a.centre.x() += h; }, 0.1);
  ellipse_column(
      1, [](Ellipse& a, double h) { a.centre.y() += h; }, 0.1);
  const double m = 0.02 * e.shape(0, 0);
  ellipse_column(
      2, [](Ellipse& a, double h) { a.shape(0, 0) += h; }, m);
  ellipse_column(
      3, [](Ellipse& a, double h) { a.shape(1, 1) += h; }, m);
  ellipse_column(
      4,
      [](Ellipse& a, double h) {
        a.shape(0, 1) += h;
        a.shape(1, 0) += h;
      },
      m);
  column(5, disc_image(e, blur_px + 0.05, side), disc_image(e, blur_px - 0.05, side), 0.1);
  for (Eigen::Index i = 0; i < n; ++i) {
    j(i, 6) = 1;
    const double value = static_cast<double>(base[static_cast<std::size_t>(i)]);
    j(i, 7) = (value - kGround_dn) / kStep_dn;
    j(i, 8) = value * (static_cast<double>(i % side) - e.centre.x());
    j(i, 9) = value * (static_cast<double>(i / side) - e.centre.y());
    j.row(i) /= std::sqrt(kDiscNoise.variance(value));
  }
  return std::sqrt((j.transpose() * j).inverse()(0, 0));
}

}  // namespace enamel::test
