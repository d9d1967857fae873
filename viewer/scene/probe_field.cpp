#include "viewer/scene/probe_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace enamel::view {

ProbeField probe_field(const Pinhole& camera, double near_mm, double far_mm) {
  ProbeField field;
  const auto& [width_px, height_px, fx_px, fy_px, cx_px, cy_px] = camera;
  const bool usable = width_px > 0 && height_px > 0 && fx_px > 0 && fy_px > 0 && near_mm > 0 && far_mm > near_mm &&
                      std::isfinite(fx_px) && std::isfinite(fy_px) && std::isfinite(cx_px) && std::isfinite(cy_px) &&
                      std::isfinite(far_mm);
  if (!usable) {
    return field;
  }
  // The image's edge lies half a pixel outside the outer pixel centres.
  const double left = (-0.5 - cx_px) / fx_px;
  const double right = (width_px - 0.5 - cx_px) / fx_px;
  const double top = (-0.5 - cy_px) / fy_px;
  const double bottom = (height_px - 0.5 - cy_px) / fy_px;
  const auto ray = [](double x, double y) { return Vec3f{static_cast<float>(x), static_cast<float>(y), 1.0F}; };
  field.corner_rays = {ray(left, top), ray(right, top), ray(right, bottom), ray(left, bottom)};
  const ProbeField standard;
  const double span = (far_mm - near_mm) / (standard.far_mm - standard.near_mm);
  field.optimum_near_mm = near_mm + span * (standard.optimum_near_mm - standard.near_mm);
  field.optimum_far_mm = near_mm + span * (standard.optimum_far_mm - standard.near_mm);
  field.near_mm = near_mm;
  field.far_mm = far_mm;
  return field;
}

FrustumGeometry frustum(const ProbeField& field, const Pose& T_dst_cam) {
  FrustumGeometry out;
  out.points[0] = T_dst_cam.translation().cast<float>();
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3d ray = field.corner_rays[i].cast<double>();
    out.points[1 + i] = (T_dst_cam * Vec3d(ray * field.near_mm)).cast<float>();
    out.points[5 + i] = (T_dst_cam * Vec3d(ray * field.far_mm)).cast<float>();
  }
  return out;
}

Ball field_ball(const ProbeField& field, const Pose& T_dst_cam) {
  const double near_mm = field.optimum_near_mm, far_mm = field.optimum_far_mm;
  const Vec3d middle(0, 0, 0.5 * (near_mm + far_mm));
  double radius = 0;
  for (const Vec3f& ray : field.corner_rays) radius = std::max(radius, (far_mm * ray.cast<double>() - middle).norm());
  return {T_dst_cam * middle, radius};
}

}  // namespace enamel::view
