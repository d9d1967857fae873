// The twin's own lens: pinhole with OpenCV's k1 k2 p1 p2 k3, written apart from calib/model on purpose, so that an
// error in one is seen by the other. Camera coordinates: x right, y down, z forward, mm; pixel centres at integers.
// Reference: OpenCV calib3d "Camera Calibration and 3D Reconstruction", projection equations.
#pragma once

#include <Eigen/Core>
#include <array>

#include "calib/model/rig.hpp"

namespace enamel::twin {

class Lens {
 public:
  explicit Lens(const calib::LensValues& values);

  /// Pixel of the point (x, y, z). False when the point lies behind the lens or so far outside the frame that the
  /// distortion polynomial no longer holds.
  [[nodiscard]] bool project(double x, double y, double z, double& u, double& v) const {
    if (z <= 0) return false;
    const double inv = 1.0 / z;
    const double a = x * inv, b = y * inv;
    const double r2 = a * a + b * b;
    if (r2 > r2_limit_) return false;
    const double g = 1.0 + r2 * (k1_ + r2 * (k2_ + r2 * k3_));
    const double ab2 = 2.0 * a * b;
    u = fx_ * (a * g + p1_ * ab2 + p2_ * (r2 + 2.0 * a * a)) + cx_;
    v = fy_ * (b * g + p1_ * (r2 + 2.0 * b * b) + p2_ * ab2) + cy_;
    return true;
  }

  /// Direction (x/z, y/z) of pixel (u, v); Newton to 1e-14.
  [[nodiscard]] Eigen::Vector2d direction(double u, double v) const;

  /// Inside the frame, borders of the outermost pixels included.
  [[nodiscard]] bool in_frame(double u, double v) const { return u >= -0.5 && v >= -0.5 && u <= u_max_ && v <= v_max_; }

 private:
  double fx_, fy_, cx_, cy_, k1_, k2_, p1_, p2_, k3_;
  double u_max_, v_max_;
  double r2_limit_ = 0;
};

}  // namespace enamel::twin
