// What the twin's tests share: a small camera, scenes in code, and a second implementation of the optics to check
// against.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tools/twin/twin_source.hpp"

namespace enamel::twin::testing {

inline calib::Rig probe_rig() {
  auto rig = calib::load_rig(std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/probe_t.json");
  EXPECT_TRUE(rig) << rig.error().message();
  return *rig;
}

/// The probe with every fourth pixel: same field, a sixteenth of the work.
inline calib::Rig small_rig() {
  calib::Rig rig = probe_rig();
  auto& c = rig.camera;
  c.width /= 4;
  c.height /= 4;
  c.fx /= 4;
  c.fy /= 4;
  c.cx = (c.cx + 0.5) / 4 - 0.5;
  c.cy = (c.cy + 0.5) / 4 - 0.5;
  return rig;
}

inline Effects ideal() {
  Effects e;
  e.round_levels = e.gamma = e.defocus = e.falloff = e.ambient = e.shadow = e.texture = e.camera_psf = false;
  e.motion = e.exposure = e.tremor = e.shot_noise = e.read_noise = false;
  return e;
}

inline SceneConfig plane_scene(double distance_mm = 48, double tilt_x_deg = 0, double tilt_y_deg = 0) {
  SceneConfig s;
  s.object = ObjectKind::kPlane;
  s.plane.grid_mm = 2.0;
  ViewConfig view;
  view.distance_mm = distance_mm;
  view.tilt_x_deg = tilt_x_deg;
  view.tilt_y_deg = tilt_y_deg;
  s.views = {view};
  return s;
}

inline std::unique_ptr<TwinSource> source_of(const SceneConfig& scene, const calib::Rig& rig) {
  auto source = TwinSource::create(scene, rig);
  EXPECT_TRUE(source) << source.error().message();
  return std::move(*source);
}

/// Own undistortion, by plain fixed-point iteration.
inline Eigen::Vector3d pixel_ray(const calib::LensValues& l, double u, double v) {
  const double xd = (u - l.cx) / l.fx, yd = (v - l.cy) / l.fy;
  double x = xd, y = yd;
  for (int i = 0; i < 60; ++i) {
    const double r2 = x * x + y * y;
    const double g = 1 + l.dist[0] * r2 + l.dist[1] * r2 * r2 + l.dist[4] * r2 * r2 * r2;
    const double tx = 2 * l.dist[2] * x * y + l.dist[3] * (r2 + 2 * x * x);
    const double ty = l.dist[2] * (r2 + 2 * y * y) + 2 * l.dist[3] * x * y;
    x = (xd - tx) / g;
    y = (yd - ty) / g;
  }
  return {x, y, 1};
}

inline Eigen::Vector2d project(const calib::LensValues& l, const Eigen::Vector3d& p) {
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const double g = 1 + l.dist[0] * r2 + l.dist[1] * r2 * r2 + l.dist[4] * r2 * r2 * r2;
  return {l.fx * (x * g + 2 * l.dist[2] * x * y + l.dist[3] * (r2 + 2 * x * x)) + l.cx,
          l.fy * (y * g + l.dist[2] * (r2 + 2 * y * y) + 2 * l.dist[3] * x * y) + l.cy};
}

inline Eigen::Isometry3d T_proj_cam(const calib::Rig& rig) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) {
      T.matrix()(r, c) = rig.T_proj_cam[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
    }
  }
  return T;
}

/// Point of the model's plane z = 0 behind a pixel, camera coordinates.
inline Eigen::Vector3d plane_point(const calib::Rig& rig, const Pose& T_model_cam, double u, double v) {
  const Eigen::Vector3d ray = pixel_ray(rig.camera, u, v);
  const double t = -T_model_cam.translation().z() / (T_model_cam.linear() * ray).z();
  return t * ray;
}

/// Projector coordinate u of that point.
inline double plane_u(const calib::Rig& rig, const Pose& T_model_cam, double u, double v) {
  return project(rig.projector, T_proj_cam(rig) * plane_point(rig, T_model_cam, u, v)).x();
}

inline constexpr double kPi = std::numbers::pi;

inline double wrap(double phi) { return phi - 2 * std::numbers::pi * std::floor(phi / (2 * std::numbers::pi) + 0.5); }

inline double phase4(const std::array<std::vector<float>, 4>& I, std::size_t i) {
  return std::atan2(static_cast<double>(I[3][i]) - static_cast<double>(I[1][i]),
                    static_cast<double>(I[0][i]) - static_cast<double>(I[2][i]));
}

}  // namespace enamel::twin::testing
