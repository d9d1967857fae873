// Patches of analytic surfaces: what a perfect or a noisy probe would deliver, by code of its own (no lens or fusion
// code).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "calib/model/rig.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::synthetic {

/// Reproducible noise: splitmix64 and Box-Muller.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double uniform();  ///< (0, 1)
  Vec3d vector();    ///< each component in (-0.5, 0.5)
  double normal();

 private:
  std::uint64_t state_;
};

struct Hit {
  double t = 0;  ///< along the ray, in units of its direction
  Vec3d normal;  ///< outwards, unit
};

/// A surface in model coordinates: nearest hit of the ray origin + t * direction, t > 0.
using Surface = std::function<std::optional<Hit>(const Vec3d& origin, const Vec3d& direction)>;

Surface sphere(const Vec3d& centre, double radius_mm);
/// n . x = offset, seen from the side n points to.
Surface plane(const Vec3d& normal, double offset_mm);
/// Upward (-z) convex edge along y through the origin: two faces at 45 degrees joined by a cylinder of that radius.
Surface wedge(double radius_mm);
/// The nearest of two.
Surface nearest(Surface a, Surface b);
/// Only where `inside` holds for the point hit.
Surface clipped(Surface a, std::function<bool(const Vec3d&)> inside);

/// A VGA rig like the reference design, lens distortion included.
calib::Rig rig();
/// Half size, for quick tests: the same field at a quarter of the pixels.
calib::Rig small_rig();

/// Camera at distance from target, looking at it along direction (both model frame), rolled about the view axis.
Pose looking_at(const Vec3d& target, const Vec3d& direction, double distance_mm, double roll_rad = 0.0);

struct RenderOptions {
  double sigma_mm = 0.0085;  ///< stated in the patch
  bool noisy = false;        ///< depth noise of sigma_mm, normals noise of 0.03 rad
  std::uint64_t seed = 1;
};

SurfacePatch render(const calib::Rig& rig, const Surface& surface, const Pose& T_model_cam,
                    const RenderOptions& options = {});

/// Ray (x, y, 1) of a camera pixel: inverse distortion by fixed-point iteration to 1e-12.
Vec3d pixel_ray(const calib::LensValues& lens, double u, double v);

}  // namespace enamel::synthetic
