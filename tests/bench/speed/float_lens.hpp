// calib::project() in single precision: what the plain loops see pixels through.
#pragma once

#include <cmath>

#include "calib/model/lens.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::bench {

class FloatLens {
 public:
  explicit FloatLens(const calib::LensValues& lens)
      : width_(lens.width),
        height_(lens.height),
        fx_(static_cast<float>(lens.fx)),
        fy_(static_cast<float>(lens.fy)),
        cx_(static_cast<float>(lens.cx)),
        cy_(static_cast<float>(lens.cy)) {
    for (std::size_t i = 0; i < dist_.size(); ++i) dist_[i] = static_cast<float>(lens.dist[i]);
  }

  /// Index of the pixel that a point falls on; -1 outside the image or behind the camera. p: camera frame, mm.
  [[nodiscard]] int pixel_of(const Vec3f& p) const noexcept {
    if (!(p.z() > 1.0F)) return -1;
    const float inverse = 1.0F / p.z();
    const float x = p.x() * inverse, y = p.y() * inverse;
    const float r2 = x * x + y * y;
    const float g = 1.0F + r2 * (dist_[0] + r2 * (dist_[1] + r2 * dist_[4]));
    const float xd = x * g + 2.0F * dist_[2] * x * y + dist_[3] * (r2 + 2.0F * x * x);
    const float yd = y * g + dist_[2] * (r2 + 2.0F * y * y) + 2.0F * dist_[3] * x * y;
    const float u = fx_ * xd + cx_ + 0.5F, v = fy_ * yd + cy_ + 0.5F;
    if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(width_) && v < static_cast<float>(height_))) return -1;
    return static_cast<int>(v) * width_ + static_cast<int>(u);
  }

 private:
  int width_, height_;
  float fx_, fy_, cx_, cy_;
  std::array<float, 5> dist_{};
};

}  // namespace enamel::bench
