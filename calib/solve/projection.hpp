// Parameter blocks of the least-squares problems and the projection through them, for double and for Jets. Private to
// calib/solve and calib/mount. A lens block is fx fy cx cy k1 k2 p1 p2 k3; a motion block is a rotation vector and a
// translation.
#pragma once

#include <ceres/rotation.h>

#include <array>

#include "calib/model/lens.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::calib {

using LensBlock = std::array<double, 9>;
using MotionBlock = std::array<double, 6>;

[[nodiscard]] inline LensBlock block_of(const LensValues& l) {
  return {l.fx, l.fy, l.cx, l.cy, l.dist[0], l.dist[1], l.dist[2], l.dist[3], l.dist[4]};
}

inline void set_lens(LensValues& l, const LensBlock& b) {
  l.fx = b[0];
  l.fy = b[1];
  l.cx = b[2];
  l.cy = b[3];
  for (std::size_t i = 0; i < 5; ++i) l.dist[i] = b[4 + i];
}

[[nodiscard]] inline MotionBlock block_of(const Pose& p) {
  const Eigen::AngleAxisd r(p.linear());
  const Vec3d w = r.angle() * r.axis();
  return {w.x(), w.y(), w.z(), p.translation().x(), p.translation().y(), p.translation().z()};
}

[[nodiscard]] inline Pose pose_of(const MotionBlock& b) {
  const Vec3d w(b[0], b[1], b[2]);
  Pose p = Pose::Identity();
  if (w.norm() > 0) p.linear() = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
  p.translation() = Vec3d(b[3], b[4], b[5]);
  return p;
}

template <class T>
[[nodiscard]] std::array<T, 3> move(const T* motion, const std::array<T, 3>& p) {
  std::array<T, 3> q;
  ceres::AngleAxisRotatePoint(motion, p.data(), q.data());
  for (std::size_t i = 0; i < 3; ++i) q[i] += motion[3 + i];
  return q;
}

template <class T>
[[nodiscard]] std::array<T, 2> image(const T* lens, const std::array<T, 3>& p) {
  const auto [x, y] = distorted(lens + 4, T(p[0] / p[2]), T(p[1] / p[2]));
  return {lens[0] * x + lens[2], lens[1] * y + lens[3]};
}

}  // namespace enamel::calib
