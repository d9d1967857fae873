#include "tools/twin/optics/lens.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::twin {

Lens::Lens(const calib::LensValues& values)
    : fx_(values.fx),
      fy_(values.fy),
      cx_(values.cx),
      cy_(values.cy),
      k1_(values.dist[0]),
      k2_(values.dist[1]),
      p1_(values.dist[2]),
      p2_(values.dist[3]),
      k3_(values.dist[4]),
      u_max_(values.width - 0.5),
      v_max_(values.height - 0.5) {
  // Twice the farthest corner: beyond it a polynomial fitted inside the frame may fold back into it.
  for (const double u : {-0.5, u_max_}) {
    for (const double v : {-0.5, v_max_}) {
      const double a = (u - cx_) / fx_, b = (v - cy_) / fy_;
      r2_limit_ = std::max(r2_limit_, 4.0 * (a * a + b * b));
    }
  }
}

Eigen::Vector2d Lens::direction(double u, double v) const {
  const double xd = (u - cx_) / fx_, yd = (v - cy_) / fy_;
  double a = xd, b = yd;
  for (int i = 0; i < 20; ++i) {
    const double r2 = a * a + b * b;
    const double g = 1.0 + r2 * (k1_ + r2 * (k2_ + r2 * k3_));
    const double dg = 2.0 * (k1_ + r2 * (2.0 * k2_ + r2 * 3.0 * k3_));  // dg/da = a*dg, dg/db = b*dg
    const double ex = a * g + 2.0 * p1_ * a * b + p2_ * (r2 + 2.0 * a * a) - xd;
    const double ey = b * g + p1_ * (r2 + 2.0 * b * b) + 2.0 * p2_ * a * b - yd;
    const double jxx = g + a * a * dg + 2.0 * p1_ * b + 6.0 * p2_ * a;
    const double jxy = a * b * dg + 2.0 * p1_ * a + 2.0 * p2_ * b;
    const double jyy = g + b * b * dg + 6.0 * p1_ * b + 2.0 * p2_ * a;
    const double det = jxx * jyy - jxy * jxy;
    const double da = (jyy * ex - jxy * ey) / det, db = (jxx * ey - jxy * ex) / det;
    a -= da;
    b -= db;
    if (std::abs(da) + std::abs(db) < 1e-15) break;
  }
  return {a, b};
}

}  // namespace enamel::twin
