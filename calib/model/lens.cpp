#include "calib/model/lens.hpp"

#include <cmath>
#include <cstddef>

namespace enamel::calib {
namespace {

constexpr int kMaxNewtonSteps = 20;
constexpr double kConverged = 1e-14;

}  // namespace

PlanePoint undistort(const LensValues& lens, PlanePoint pixel) noexcept {
  const PlanePoint target{(pixel.x - lens.cx) / lens.fx, (pixel.y - lens.cy) / lens.fy};
  const auto& [k1, k2, p1, p2, k3] = lens.dist;
  PlanePoint p = target;
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const PlanePoint d = distort(lens, p);
    const double ex = target.x - d.x;
    const double ey = target.y - d.y;
    if (std::abs(ex) < kConverged && std::abs(ey) < kConverged) break;
    const double r2 = p.x * p.x + p.y * p.y;
    const double g = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double dg = k1 + r2 * (2 * k2 + r2 * 3 * k3);  // dg / d(r2)
    const double jxx = g + 2 * p.x * p.x * dg + 2 * p1 * p.y + 6 * p2 * p.x;
    const double jxy = 2 * p.x * p.y * dg + 2 * p1 * p.x + 2 * p2 * p.y;
    const double jyy = g + 2 * p.y * p.y * dg + 6 * p1 * p.y + 2 * p2 * p.x;
    const double det = jxx * jyy - jxy * jxy;
    if (!(std::abs(det) > 1e-9)) break;
    p.x += (jyy * ex - jxy * ey) / det;
    p.y += (jxx * ey - jxy * ex) / det;
  }
  return p;
}

PlanePoint project_to_projector(const Rig& rig, PlanePoint ray, double z_mm) noexcept {
  const auto& t = rig.T_proj_cam;
  const double px = (t[0][0] * ray.x + t[0][1] * ray.y + t[0][2]) * z_mm + t[0][3];
  const double py = (t[1][0] * ray.x + t[1][1] * ray.y + t[1][2]) * z_mm + t[1][3];
  const double pz = (t[2][0] * ray.x + t[2][1] * ray.y + t[2][2]) * z_mm + t[2][3];
  return project(rig.projector, {px / pz, py / pz});
}

RayTable make_ray_table(const LensValues& camera) {
  RayTable table{camera.width, camera.height, {}, {}};
  const std::size_t n = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  table.x.reserve(n);
  table.y.reserve(n);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const PlanePoint p = undistort(camera, {static_cast<double>(u), static_cast<double>(v)});
      table.x.push_back(static_cast<float>(p.x));
      table.y.push_back(static_cast<float>(p.y));
    }
  }
  return table;
}

}  // namespace enamel::calib
