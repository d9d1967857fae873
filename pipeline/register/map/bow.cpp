#include "pipeline/register/map/bow.hpp"

#include <cmath>

namespace enamel::pipeline {

BowField::BowField(const calib::Rig& rig)
    : inverse_half_x_(2 * rig.camera.fx / rig.camera.width),
      inverse_half_y_(2 * rig.camera.fy / rig.camera.height),
      middle_mm_(calib::middle_depth_mm(rig)) {}

BowVector BowField::terms(double x, double y) const {
  const double u = x * inverse_half_x_, v = y * inverse_half_y_;
  return {u * u, u * v, v * v};
}

BowShifts BowField::shifts(const Vec3d& p) const {
  // z is off by (z / middle)^2 terms(X / z, Y / z), the point by that along (X, Y, Z) / z.
  return p * terms(p.x(), p.y()).transpose() / (p.z() * middle_mm_ * middle_mm_);
}

void BowField::take_out(const BowVector& bow, SurfacePatch& patch) const {
  for (std::size_t i = 0; i < patch.depth_mm.size(); ++i) {
    if (!std::isfinite(patch.depth_mm[i])) continue;
    const Vec3d p = patch.points[i].cast<double>();
    const double scale = 1 / (p.z() * middle_mm_ * middle_mm_);
    const double share = bow.dot(terms(p.x(), p.y())) * scale;  // of the ray's length
    const double u = p.x() * inverse_half_x_, v = p.y() * inverse_half_y_;
    const Vec3d slope(scale * (2 * bow[0] * u + bow[1] * v) * inverse_half_x_,
                      scale * (bow[1] * u + 2 * bow[2] * v) * inverse_half_y_, -share / p.z());
    patch.depth_mm[i] = static_cast<float>(patch.depth_mm[i] * (1 - share));
    patch.points[i] = (p * (1 - share)).cast<float>();
    const Vec3d n = patch.normals[i].cast<double>();
    // p -> (1 - share) p has the derivative 1 - share - p slope^T; normals go by its inverse transposed.
    patch.normals[i] = (n + slope * p.dot(n)).normalized().cast<float>();
  }
}

}  // namespace enamel::pipeline
