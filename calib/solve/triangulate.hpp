// A point from a camera pixel and the projector coordinate seen there, by the rig as it stands: the reference that the
// pipeline's baked tables approximate.
#pragma once

#include "calib/solve/observation.hpp"

namespace enamel::calib {

/// Direction (x, y, 1) of a camera pixel.
[[nodiscard]] Vec3d camera_ray(const LensValues& camera, double u, double v);

/// Projector coordinate u of a point in camera coordinates, by the parametric model.
[[nodiscard]] double projector_u(const RigState& rig, const Vec3d& point);

/// Point on `ray` (z = 1) that the projector sees at u, camera coordinates, mm; Newton from `start_mm` along z, to
/// 1e-10 mm, then the rig's correction of 1/z.
[[nodiscard]] Vec3d triangulate(const RigState& rig, const Vec3d& ray, double u, double start_mm);

}  // namespace enamel::calib
