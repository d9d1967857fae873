// An ellipse in the image. Pixel centres at integers.
#pragma once

#include <Eigen/Core>
#include <cmath>

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
  [[nodiscard]] Eigen::Vector2d half_axes() const {
    const double middle = 0.5 * shape.trace();
    const double apart = std::hypot(0.5 * (shape(0, 0) - shape(1, 1)), shape(0, 1));
    return {1 / std::sqrt(middle - apart), 1 / std::sqrt(middle + apart)};
  }
};

}  // namespace enamel::calib
