// The lens model of rig/1: OpenCV's pinhole with k1 k2 p1 p2 k3, for the camera and (as an inverse camera) the
// projector. Normalised coordinates are x = X/Z, y = Y/Z (z forward); pixel centres lie at integers. Pure functions,
// thread-safe.
#pragma once

#include <array>

#include "calib/model/rig.hpp"
#include "protocol/base/staggered.hpp"

namespace enamel::calib {

struct PlanePoint {
  double x = 0, y = 0;
};

/// The distortion formula itself for any number type (double, an automatic derivative): coefficients k1 k2 p1 p2 k3,
/// normalised ideal (x, y) -> normalised distorted {x, y}.
template <class T>
[[nodiscard]] std::array<T, 2> distorted(const T* coefficients, const T& x, const T& y) {
  const T &k1 = coefficients[0], &k2 = coefficients[1], &p1 = coefficients[2], &p2 = coefficients[3],
          &k3 = coefficients[4];
  const T r2 = x * x + y * y;
  const T g = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * g + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), y * g + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

/// Normalised ideal -> normalised distorted.
[[nodiscard]] inline PlanePoint distort(const LensValues& lens, PlanePoint p) noexcept {
  const auto [x, y] = distorted(lens.dist.data(), p.x, p.y);
  return {x, y};
}

/// Normalised ideal -> pixel.
[[nodiscard]] inline PlanePoint project(const LensValues& lens, PlanePoint p) noexcept {
  const PlanePoint d = distort(lens, p);
  return {lens.fx * d.x + lens.cx, lens.fy * d.y + lens.cy};
}

/// Pixel -> normalised ideal: Newton on distort(), residual below 1e-13 for any lens whose distortion is invertible
/// there.
[[nodiscard]] PlanePoint undistort(const LensValues& lens, PlanePoint pixel) noexcept;

/// A pixel and depth (camera z, mm) of the camera seen by the projector: its pixel. Exact, no iteration.
/// Needs z > 0 and the point in front of the projector.
[[nodiscard]] PlanePoint project_to_projector(const Rig& rig, PlanePoint ray, double z_mm) noexcept;

/// Ideal directions (x, y, 1) of all pixel centres, row major.
struct RayTable {
  int width = 0, height = 0;
  StaggeredVector<float> x, y;
};

[[nodiscard]] RayTable make_ray_table(const LensValues& camera);

}  // namespace enamel::calib
