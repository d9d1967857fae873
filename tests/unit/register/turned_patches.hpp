// Patches of the analytic surface from other sides, and their mirror images, for tests of finding again.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>

#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::testing {

/// Looking at (x, y) tilted by `tilt_deg` towards `azimuth_deg`, the camera rolled by `roll_deg`.
inline Pose looking_from(double x, double y, double tilt_deg, double azimuth_deg, double roll_deg) {
  constexpr double kRad = std::numbers::pi / 180;
  const Vec3d axis(-std::sin(azimuth_deg * kRad), std::cos(azimuth_deg * kRad), 0);
  const Pose T = looking_down(x, y, tilt_deg * kRad * axis);
  const Vec3d work(0, 0, 48);
  return T * Eigen::Translation3d(work) * Eigen::AngleAxisd(roll_deg * kRad, Vec3d::UnitZ()) *
         Eigen::Translation3d(-work);
}

/// What the camera would see of the surface's mirror image: teeth of the other side of the mouth are nearly that.
inline SurfacePatch mirrored(SurfacePatch patch) {
  const auto flip = [](auto& map) {
    for (int v = 0; v < map.height(); ++v) {
      for (int u = 0; u < map.width() / 2; ++u) std::swap(map(u, v), map(map.width() - 1 - u, v));
    }
  };
  flip(patch.depth_mm);
  flip(patch.sigma_mm);
  flip(patch.points);
  flip(patch.normals);
  flip(patch.texture_dn);
  flip(patch.modulation_dn);
  for (Vec3f& p : patch.points.pixels()) p.x() = -p.x();
  for (Vec3f& n : patch.normals.pixels()) n.x() = -n.x();
  return patch;
}

}  // namespace enamel::testing
