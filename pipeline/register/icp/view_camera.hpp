// Where a camera-frame point falls in an ideal picture of the camera (ModelView): the association step of projective
// ICP. Float on purpose: the result is only rounded to a pixel, never part of a residual.
#pragma once

#include "calib/model/rig.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// The camera's fx fy cx cy without its lens errors, as ModelView is drawn. Immutable, thread-safe.
class ViewCamera {
 public:
  ViewCamera() = default;
  explicit ViewCamera(const calib::LensValues& lens)
      : fx_(static_cast<float>(lens.fx)),
        fy_(static_cast<float>(lens.fy)),
        cx_(static_cast<float>(lens.cx)),
        cy_(static_cast<float>(lens.cy)) {}

  /// p in camera coordinates (mm), p.z() > 0. Camera pixels; may lie outside the image.
  [[nodiscard]] Vec2f project(const Vec3f& p) const noexcept {
    const float inv_z = 1.0F / p.z();
    return {fx_ * (p.x() * inv_z) + cx_, fy_ * (p.y() * inv_z) + cy_};
  }
  [[nodiscard]] float fx() const noexcept { return fx_; }
  [[nodiscard]] float fy() const noexcept { return fy_; }
  [[nodiscard]] float cx() const noexcept { return cx_; }
  [[nodiscard]] float cy() const noexcept { return cy_; }

 private:
  float fx_ = 1, fy_ = 1, cx_ = 0, cy_ = 0;
};

}  // namespace enamel::pipeline
