// Where a camera looks, and whether two look the same way.
#pragma once

#include <numbers>

#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

struct Closeness {
  double mm, deg;  ///< at the point looked at, and of any turn
};

/// Nearer than both limits.
[[nodiscard]] inline bool look_alike(const Pose& a, const Pose& b, const Vec3d& looked_at, const Closeness& limits) {
  const Eigen::AngleAxisd turn(a.linear().transpose() * b.linear());
  return (a * looked_at - b * looked_at).norm() < limits.mm && turn.angle() < limits.deg * std::numbers::pi / 180;
}

}  // namespace enamel::pipeline
