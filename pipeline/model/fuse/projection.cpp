#include "pipeline/model/fuse/projection.hpp"

#include "calib/model/lens.hpp"

namespace enamel::pipeline {

LocalProjection local_projection(const calib::LensValues& lens, const Vec3d& p, int stride) {
  const double x = p.x() / p.z();
  const double y = p.y() / p.z();
  const auto& [k1, k2, p1, p2, k3] = lens.dist;
  const double r2 = x * x + y * y;
  const double g = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double dg = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);  // dg/d(r^2)
  const auto [xd, yd] = calib::distort(lens, {x, y});
  const double xx = g + 2.0 * x * x * dg + 2.0 * p1 * y + 6.0 * p2 * x;
  const double xy = 2.0 * x * y * dg + 2.0 * p1 * x + 2.0 * p2 * y;  // the Jacobian is symmetric
  const double yy = g + 2.0 * y * y * dg + 6.0 * p1 * y + 2.0 * p2 * x;
  const double fx = lens.fx / stride;
  const double fy = lens.fy / stride;
  LocalProjection local;
  local.uX = static_cast<float>(fx * xx);
  local.uY = static_cast<float>(fx * xy);
  local.vX = static_cast<float>(fy * xy);
  local.vY = static_cast<float>(fy * yy);
  local.u0 = static_cast<float>(lens.cx / stride + fx * (xd - xx * x - xy * y));
  local.v0 = static_cast<float>(lens.cy / stride + fy * (yd - xy * x - yy * y));
  return local;
}

}  // namespace enamel::pipeline
