#include "tools/twin/path/arch.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::twin {
namespace {
constexpr double kStepMm = 0.25;
constexpr double kLengthMm = 70;  // beyond the last molar of any arch
}  // namespace

Arch::Arch(const ArchShape& shape) {
  // March along the curve in steps of equal length; the sub-steps keep the sum of chords within 1 um of the arc.
  const auto y_at = [&](double x) { return -shape.depth_mm * std::pow(x / shape.half_width_mm, shape.exponent); };
  constexpr int kSubSteps = 20;
  Eigen::Vector2d p(0, 0);
  double x = 0;
  for (double s = 0; s <= kLengthMm; s += kStepMm) {
    points_.push_back(p);
    for (int i = 0; i < kSubSteps; ++i) {
      constexpr double kTiny = 1e-4;
      const double slope = (y_at(x + kTiny) - y_at(x)) / kTiny;
      x += kStepMm / kSubSteps / std::sqrt(1.0 + slope * slope);
    }
    p = {x, y_at(x)};
  }
}

Eigen::Vector2d Arch::point(double s) const {
  const double a = std::abs(s) / kStepMm;
  const auto last = static_cast<double>(points_.size() - 2);
  const double i0 = std::min(std::floor(a), last);
  const auto i = static_cast<std::size_t>(i0);
  const double t = a - i0;
  // Quadratic through three neighbours: continuous enough for a hand-held motion.
  const Eigen::Vector2d& p0 = i == 0 ? Eigen::Vector2d(-points_[1].x(), points_[1].y()) : points_[i - 1];
  const Eigen::Vector2d p1 = points_[i], p2 = points_[i + 1];
  const Eigen::Vector2d p3 = i + 2 < points_.size() ? points_[i + 2] : Eigen::Vector2d(2.0 * p2 - p1);
  const Eigen::Vector2d m1 = 0.5 * (p2 - p0), m2 = 0.5 * (p3 - p1);
  Eigen::Vector2d p;
  if (a > last + 1.0) {
    p = p2 + (a - last - 1.0) * (p2 - p1);
  } else {
    const double t2 = t * t, t3 = t2 * t;
    p = (2 * t3 - 3 * t2 + 1) * p1 + (t3 - 2 * t2 + t) * m1 + (3 * t2 - 2 * t3) * p2 + (t3 - t2) * m2;
  }
  if (s < 0) p.x() = -p.x();
  return p;
}

Eigen::Vector2d Arch::tangent(double s) const {
  constexpr double kHalf = 0.5;  // mm: smooths over the table
  return (point(s + kHalf) - point(s - kHalf)).normalized();
}

Eigen::Vector2d Arch::buccal(double s) const {
  const Eigen::Vector2d t = tangent(s);
  return {-t.y(), t.x()};
}

}  // namespace enamel::twin
