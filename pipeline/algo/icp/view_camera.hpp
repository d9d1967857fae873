// Where a camera-frame point falls in the camera's (distorted) image: the association step of projective ICP.
// Float on purpose: the result is only rounded to a pixel, never part of a residual.
#pragma once

#include "calib/model/rig.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::algo {

/// Pinhole with k1 k2 p1 p2 k3 (OpenCV's model), pixel centres at integers. Immutable, thread-safe.
class ViewCamera {
 public:
  ViewCamera() = default;
  explicit ViewCamera(const calib::LensValues& lens)
      : width_(lens.width),
        height_(lens.height),
        fx_(static_cast<float>(lens.fx)),
        fy_(static_cast<float>(lens.fy)),
        cx_(static_cast<float>(lens.cx)),
        cy_(static_cast<float>(lens.cy)),
        k1_(static_cast<float>(lens.dist[0])),
        k2_(static_cast<float>(lens.dist[1])),
        p1_(static_cast<float>(lens.dist[2])),
        p2_(static_cast<float>(lens.dist[3])),
        k3_(static_cast<float>(lens.dist[4])) {}

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }

  /// p in camera coordinates (mm), p.z() > 0. Result in pixels; may lie outside the image.
  [[nodiscard]] Vec2f project(const Vec3f& p) const noexcept {
    const float inv_z = 1.0F / p.z();
    const float x = p.x() * inv_z;
    const float y = p.y() * inv_z;
    const float r2 = x * x + y * y;
    const float g = 1.0F + r2 * (k1_ + r2 * (k2_ + r2 * k3_));
    const float xd = x * g + 2.0F * p1_ * x * y + p2_ * (r2 + 2.0F * x * x);
    const float yd = y * g + p1_ * (r2 + 2.0F * y * y) + 2.0F * p2_ * x * y;
    return {fx_ * xd + cx_, fy_ * yd + cy_};
  }

 private:
  int width_ = 0;
  int height_ = 0;
  float fx_ = 1, fy_ = 1, cx_ = 0, cy_ = 0;
  float k1_ = 0, k2_ = 0, p1_ = 0, p2_ = 0, k3_ = 0;
};

}  // namespace enamel::algo
