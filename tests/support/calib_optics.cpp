#include "tests/support/calib_optics.hpp"

#include <cmath>
#include <numbers>

namespace enamel::test {

using calib::LensValues;
using Eigen::Vector2d;

Vector2d pixel_of(const LensValues& l, const Vec3d& p) {
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const double g = 1 + l.dist[0] * r2 + l.dist[1] * r2 * r2 + l.dist[4] * r2 * r2 * r2;
  return {l.fx * (x * g + 2 * l.dist[2] * x * y + l.dist[3] * (r2 + 2 * x * x)) + l.cx,
          l.fy * (y * g + l.dist[2] * (r2 + 2 * y * y) + 2 * l.dist[3] * x * y) + l.cy};
}

Vec3d ray_of(const LensValues& l, const Vector2d& px) {
  const Vector2d goal((px.x() - l.cx) / l.fx, (px.y() - l.cy) / l.fy);
  Vector2d p = goal;
  for (int i = 0; i < 30; ++i) {
    const Vector2d q = pixel_of(l, {p.x(), p.y(), 1});
    const Vector2d d((q.x() - px.x()) / l.fx, (q.y() - px.y()) / l.fy);
    p -= d;
    if (d.norm() < 1e-14) break;
  }
  return {p.x(), p.y(), 1};
}

Vec3d place(const CalibScene& s, int dot) {
  return s.target.place(dot) + s.truth.dot_offsets_mm[static_cast<std::size_t>(dot)];
}

Vector2d projector_pixel(const CalibScene& s, const Vec3d& p) {
  const double x = p.x() / 8;
  const Vec3d bowed = p * (1 + 1e-3 * s.bow_um * x * x / p.z());
  Vector2d q = pixel_of(s.truth.projector, s.truth.T_proj_cam * bowed);
  if (s.wave_px > 0)
    q.x() += s.wave_px * std::sin(2 * std::numbers::pi * (1.2 * q.x() / s.truth.projector.width + 0.1)) *
             std::cos(2 * std::numbers::pi * (0.7 * q.y() / s.truth.projector.height + 0.2));
  return q;
}

}  // namespace enamel::test
