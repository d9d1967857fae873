#include "calib/solve/triangulate.hpp"

#include <algorithm>
#include <cmath>

#include "calib/model/lens.hpp"

namespace enamel::calib {
namespace {

constexpr int kNewtonSteps = 12;
constexpr double kSettled_mm = 1e-10;
constexpr double kDifference_mm = 1e-4;  // of the slope: its error only slows the convergence down
constexpr double kMaxStep_mm = 5;

}  // namespace

Vec3d camera_ray(const LensValues& camera, double u, double v) {
  const PlanePoint p = undistort(camera, {u, v});
  return {p.x, p.y, 1};
}

double projector_u(const RigState& rig, const Vec3d& point) {
  const Vec3d q = rig.T_proj_cam * point;
  return project(rig.projector, {q.x() / q.z(), q.y() / q.z()}).x;
}

Vec3d triangulate(const RigState& rig, const Vec3d& ray, double u, double start_mm) {
  double z = start_mm;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const double rise = projector_u(rig, ray * (z + kDifference_mm)) - projector_u(rig, ray * (z - kDifference_mm));
    const double step = (u - projector_u(rig, ray * z)) * 2 * kDifference_mm / rise;
    const double dz = std::clamp(step, -kMaxStep_mm, kMaxStep_mm);
    z += dz;
    if (std::abs(dz) < kSettled_mm) break;
  }
  if (rig.correction) {
    const PlanePoint pixel = project(rig.camera, {ray.x() / ray.z(), ray.y() / ray.z()});
    z = 1 / (1 / z + correction_at(*rig.correction, pixel.x, pixel.y, 1 / z));
  }
  return ray * z;
}

}  // namespace enamel::calib
