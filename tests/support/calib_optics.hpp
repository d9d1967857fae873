// How the tests' calibration scenes see and light: the lens formula, its inverse and the scene's projector.
#pragma once

#include <Eigen/Core>

#include "tests/support/calib_scene.hpp"

namespace enamel::test {

/// OpenCV's formula, written out.
[[nodiscard]] Eigen::Vector2d pixel_of(const calib::LensValues& l, const Vec3d& p);

/// Fixed-point inversion of the formula above.
[[nodiscard]] Vec3d ray_of(const calib::LensValues& l, const Eigen::Vector2d& px);

/// Of a dot in the target's coordinates, its offset included.
[[nodiscard]] Vec3d place(const CalibScene& s, int dot);

/// Where the scene's projector lights a point in camera coordinates from.
[[nodiscard]] Eigen::Vector2d projector_pixel(const CalibScene& s, const Vec3d& p);

}  // namespace enamel::test
