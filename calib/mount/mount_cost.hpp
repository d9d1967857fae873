// Residuals of the mount's adjustment, for double and for Jets. Private to calib/mount. A line block is (a, b, c, d):
// direction d0 + a e1 + b e2, normalised, through p0 + c e1 + d e2, with (e1, e2, d0) right-handed.
#pragma once

#include <Eigen/Core>
#include <array>

#include "calib/model/mount.hpp"
#include "calib/solve/observation.hpp"
#include "calib/solve/projection.hpp"

namespace enamel::calib {

using LineBlock = std::array<double, 4>;
using StopBlock = std::array<double, 5>;   ///< corrections of rotation and swing, rad; shift of the table, camera, mm
using DriveBlock = std::array<double, 6>;  ///< harmonics of rotation (cos, sin) and swing, play of both; rad

/// A line about which a block counts.
struct LineBase {
  Vec3d d0{0, 0, 1}, e1{1, 0, 0}, e2{0, 1, 0}, p0{0, 0, 0};

  template <class T>
  [[nodiscard]] std::array<T, 3> direction(const T* b) const {
    const T length = sqrt(1.0 + b[0] * b[0] + b[1] * b[1]);
    std::array<T, 3> out;
    for (int i = 0; i < 3; ++i) out[static_cast<std::size_t>(i)] = (d0[i] + b[0] * e1[i] + b[1] * e2[i]) / length;
    return out;
  }
  template <class T>
  [[nodiscard]] std::array<T, 3> point(const T* b) const {
    std::array<T, 3> out;
    for (int i = 0; i < 3; ++i) out[static_cast<std::size_t>(i)] = p0[i] + b[2] * e1[i] + b[3] * e2[i];
    return out;
  }
};

/// A stop as the model has it.
struct StopModel {
  LineBase rotation, swing;
  AxisAngles angles;
  bool is_rotation_loose = false, is_swing_loose = false;  ///< reached against the approach: the play counts

  /// Board's place at both angles 0 -> camera.
  template <class T>
  [[nodiscard]] std::array<T, 3> place(const T* r, const T* s, const T* drive, const T* stop,
                                       const std::array<T, 3>& p) const {
    T turn = true_angle(angles.rotation(), stop[0], drive[0], drive[1]);
    T tilt = true_angle(angles.swing(), stop[1], drive[2], drive[3]);
    if (is_rotation_loose) turn += drive[4];
    if (is_swing_loose) tilt += drive[5];
    const auto on_cradle = turned(rotation.direction(r), rotation.point(r), turn, p);
    auto q = turned(swing.direction(s), swing.point(s), tilt, on_cradle);
    for (std::size_t i = 0; i < 3; ++i) q[i] += stop[2 + i];
    return q;
  }
};

/// One dot in the camera's picture and, with a map, in the projector's: the latter at the predicted camera place, so
/// that it does not share the centre's error (docs/calibration.md §5).
struct MountDotCost {
  const StopModel* model = nullptr;
  const LensBlock *camera = nullptr, *projector = nullptr;
  const MotionBlock* relative = nullptr;
  Vec3d place_mm{0, 0, 0};
  Eigen::Vector2d camera_px{0, 0};
  Eigen::Matrix2d whitening = Eigen::Matrix2d::Identity();
  LocalMap map;
  bool has_projector = false;

  /// With the rig as it stands.
  template <class T>
  bool operator()(const T* r, const T* s, const T* drive, const T* board, const T* stop, T* residual) const {
    std::array<T, 9> by_camera, by_projector;
    for (std::size_t i = 0; i < 9; ++i) by_camera[i] = T((*camera)[i]), by_projector[i] = T((*projector)[i]);
    std::array<T, 6> to_projector;
    for (std::size_t i = 0; i < 6; ++i) to_projector[i] = T((*relative)[i]);
    const std::array<const T*, 8> blocks{
        r, s, drive, board, stop, by_camera.data(), by_projector.data(), to_projector.data()};
    return (*this)(blocks.data(), residual);
  }

  /// With the rig's blocks as parameters, too: rotation, swing, drive, board, stop, camera, projector, T_proj_cam.
  template <class T>
  bool operator()(const T* const* b, T* residual) const {
    const std::array<T, 3> design{T(place_mm.x()), T(place_mm.y()), T(place_mm.z())};
    const auto p = model->place(b[0], b[1], b[2], b[4], move(b[3], design));
    if (!(p[2] > 0.0)) return false;
    const auto seen = image(b[5], p);
    const T du = seen[0] - camera_px.x(), dv = seen[1] - camera_px.y();
    residual[0] = whitening(0, 0) * du + whitening(0, 1) * dv;
    residual[1] = whitening(1, 0) * du + whitening(1, 1) * dv;
    residual[2] = residual[3] = T(0.0);
    if (!has_projector) return true;
    const auto lit = image(b[6], move(b[7], p));
    for (int k = 0; k < 2; ++k) {
      const T there = map.projector_px[k] + map.jacobian(k, 0) * du + map.jacobian(k, 1) * dv;
      residual[2 + k] = (there - lit[static_cast<std::size_t>(k)]) / std::sqrt(map.variance_px2[k]);
    }
    return true;
  }
};

}  // namespace enamel::calib
