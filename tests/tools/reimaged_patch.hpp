// A patch as the same camera would have taken it, rolled about its axis, or of the mirrored surface.
#pragma once

#include <cmath>
#include <limits>

#include "calib/model/lens.hpp"
#include "calib/model/rig.hpp"
#include "pipeline/types/patch.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::test {

/// M_old_new: a turn about z, or diag(-1, 1, 1). Each new pixel takes the old one nearest to its ray, its point moved:
/// half a pixel beside its ray at most, and still where it was measured. What the old picture does not show is missing.
inline SurfacePatch reimaged(const SurfacePatch& patch, const calib::LensValues& lens,
                             const Eigen::Matrix3d& M_old_new) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const int width = patch.points.width();
  const int height = patch.points.height();
  SurfacePatch out;
  out.depth_mm = Map<float>(width, height, kNan);
  out.sigma_mm = out.depth_mm;
  out.points = Map<Vec3f>(width, height, Vec3f::Constant(kNan));
  out.normals = out.points;
  out.texture_dn = Map<float>(width, height, 0.0F);
  out.modulation_dn = out.texture_dn;
  const Eigen::Matrix3f M_new_old = M_old_new.transpose().cast<float>();
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const Vec3d ray = M_old_new * testing::pixel_ray(lens, u, v);
      const auto px = calib::project(lens, {ray.x(), ray.y()});
      const int from_u = static_cast<int>(std::lround(px.x));
      const int from_v = static_cast<int>(std::lround(px.y));
      if (!patch.points.contains(from_u, from_v)) continue;
      out.depth_mm(u, v) = patch.depth_mm(from_u, from_v);
      out.sigma_mm(u, v) = patch.sigma_mm(from_u, from_v);
      out.points(u, v) = M_new_old * patch.points(from_u, from_v);
      out.normals(u, v) = M_new_old * patch.normals(from_u, from_v);
      out.texture_dn(u, v) = patch.texture_dn(from_u, from_v);
      out.modulation_dn(u, v) = patch.modulation_dn(from_u, from_v);
      out.valid_px += out.depth_mm(u, v) == out.depth_mm(u, v) ? 1U : 0U;
    }
  }
  return out;
}

}  // namespace enamel::test
