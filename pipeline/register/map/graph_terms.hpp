// What all terms of the graph share: turns as matrices, the scale of residuals, the switch. Private to register/map.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// cross_matrix(v) * w = v x w
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Vec3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Upper median, which false terms hardly move. values not empty.
[[nodiscard]] inline double middle_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Weight of a term that may be false (dynamic covariance scaling, Agarwal et al., ICRA 2013): 1 up to `sigmas`, then
/// less and less. chi2: over its degrees of freedom.
[[nodiscard]] inline double switch_of(double chi2, double sigmas) {
  const double phi = sigmas * sigmas;
  const double s = std::min(1.0, 2 * phi / (phi + chi2));
  return s * s;
}

}  // namespace enamel::pipeline
