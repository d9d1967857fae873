// An endless analytic tooth-like surface, seen by a camera: exact patches and views at any pose, with noise on request.
// Test support only; shares no projection code with the pipeline (rays by its own fixed-point undistortion).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "calib/model/rig.hpp"
#include "pipeline/types/model_view.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::testing {

/// splitmix64 of a key: the same number for the same key, in any order of calls.
inline std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31U);
}
inline double uniform(std::uint64_t key) { return static_cast<double>(mix(key) >> 11U) * 0x1.0p-53; }
/// Standard normal by Box-Muller.
inline double normal(std::uint64_t key) {
  const double radius = std::sqrt(-2 * std::log(1 - uniform(2 * key)));
  return radius * std::cos(2 * std::numbers::pi * uniform(2 * key + 1));
}

/// Uniform cubic B-spline on an endless grid of hashed coefficients: C2, value and gradient in closed form.
class SplineField {
 public:
  /// repeat: the field comes again along x after so many grid steps; 0: never.
  SplineField(std::uint64_t seed, double pitch_mm, double amplitude, std::int64_t repeat = 0)
      : seed_(mix(seed)), pitch_(pitch_mm), amp_(amplitude), repeat_(repeat) {}

  struct Value {
    double f = 0, fx = 0, fy = 0;
  };
  [[nodiscard]] Value at(double x, double y) const {
    const double gx = x / pitch_, gy = y / pitch_;
    const double ix = std::floor(gx), iy = std::floor(gy);
    const auto bx = basis(gx - ix), by = basis(gy - iy);
    Value out;
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        const double c = coefficient(static_cast<std::int64_t>(ix) + i, static_cast<std::int64_t>(iy) + j);
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        out.f += c * bx[a][0] * by[b][0];
        out.fx += c * bx[a][1] * by[b][0] / pitch_;
        out.fy += c * bx[a][0] * by[b][1] / pitch_;
      }
    }
    return out;
  }

 private:
  using Basis = std::array<std::array<double, 2>, 4>;  ///< value, derivative
  static Basis basis(double t) {
    const double s = 1 - t;
    return {{{s * s * s / 6, -s * s / 2},
             {(3 * t * t * t - 6 * t * t + 4) / 6, (9 * t * t - 12 * t) / 6},
             {(-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, (-9 * t * t + 6 * t + 3) / 6},
             {t * t * t / 6, t * t / 2}}};
  }
  [[nodiscard]] double coefficient(std::int64_t i, std::int64_t j) const {
    if (repeat_ > 0) i = (i % repeat_ + repeat_) % repeat_;
    return amp_ *
           (2 * uniform(seed_ ^ mix(static_cast<std::uint64_t>(i) * 0x1F123BB5ULL + static_cast<std::uint64_t>(j))) -
            1);
  }
  std::uint64_t seed_;
  double pitch_, amp_;
  std::int64_t repeat_;
};

/// Height field z = h(x, y) in model coordinates (mm), z towards the camera, with a smooth mottled albedo.
class SyntheticSurface {
 public:
  /// relief 1: cusps of about ±1 mm on a 2 mm raster with fissures; 0: the plane z = 0 (texture stays).
  /// repeat: everything comes again along x after 8 * repeat mm, as teeth nearly do; 0: never.
  explicit SyntheticSurface(std::uint64_t seed, double relief = 1, std::int64_t repeat = 0)
      : cusps_(seed * 8 + 1, 2.0, 2.0 * relief, 4 * repeat),
        bumps_(seed * 8 + 2, 0.5, 0.15 * relief, 16 * repeat),
        albedo_(seed * 8 + 3, 0.32, 0.12, 25 * repeat) {}

  [[nodiscard]] SplineField::Value height(double x, double y) const {
    const auto a = cusps_.at(x, y), b = bumps_.at(x, y);
    return {a.f + b.f, a.fx + b.fx, a.fy + b.fy};
  }
  [[nodiscard]] double albedo(double x, double y) const { return 0.75 + albedo_.at(x, y).f; }
  [[nodiscard]] Vec3d normal_at(double x, double y) const {
    const auto h = height(x, y);
    return Vec3d(-h.fx, -h.fy, 1).normalized();
  }
  /// Point where the ray o + s d meets the surface, by Newton from s0; NaN when it does not settle.
  [[nodiscard]] Vec3d hit(const Vec3d& o, const Vec3d& d, double s0) const {
    double s = s0;
    for (int k = 0; k < 30; ++k) {
      const Vec3d p = o + s * d;
      const auto h = height(p.x(), p.y());
      const double slope = d.z() - h.fx * d.x() - h.fy * d.y();
      const double step = (p.z() - h.f) / slope;
      s -= std::abs(step) > 1 ? std::copysign(1.0, step) : step;
      if (std::abs(step) < 1e-7) return o + s * d;
    }
    return Vec3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }

 private:
  SplineField cusps_, bumps_, albedo_;
};

/// The optics of the reference probe at 1/shrink of its pixels (same field, mild distortion).
inline calib::Rig test_rig(int shrink = 2) {
  calib::Rig rig;
  const double s = shrink;
  rig.camera = {
      640 / shrink, 480 / shrink, 1707 / s, 1707 / s, 321.3 / s, 238.1 / s, {-0.05, 0.01, 0.0003, -0.0002, 0}};
  rig.depth_range = calib::DepthRange{40, 56};
  return rig;
}

/// Looking straight down from 48 mm above (x, y), camera x along model x; then turned about the point 48 mm ahead.
inline Pose looking_down(double x, double y, const Vec3d& rotation_vector_rad = Vec3d::Zero(), double z = 0) {
  Pose T = Pose::Identity();
  T.linear() = Vec3d(1, -1, -1).asDiagonal();
  const double angle = rotation_vector_rad.norm();
  if (angle > 0) T.linear() = Eigen::AngleAxisd(angle, rotation_vector_rad / angle).toRotationMatrix() * T.linear();
  T.translation() = Vec3d(x, y, z) - T.linear() * Vec3d(0, 0, 48);
  return T;
}

/// x, y of the undistorted ray of pixel (u, v): 8 fixed-point steps of the distortion model.
inline Vec3d pixel_ray(const calib::LensValues& c, double u, double v) {
  const double xd = (u - c.cx) / c.fx, yd = (v - c.cy) / c.fy;
  double x = xd, y = yd;
  for (int k = 0; k < 8; ++k) {
    const double r2 = x * x + y * y;
    const double g = 1 + r2 * (c.dist[0] + r2 * (c.dist[1] + r2 * c.dist[4]));
    const double dx = 2 * c.dist[2] * x * y + c.dist[3] * (r2 + 2 * x * x);
    const double dy = c.dist[2] * (r2 + 2 * y * y) + 2 * c.dist[3] * x * y;
    x = (xd - dx) / g;
    y = (yd - dy) / g;
  }
  return {x, y, 1};
}

struct PatchNoise {
  double sigma_mm = 0;       ///< independent depth noise a pixel
  double normal_rad = 0.03;  ///< of each tangential component of the normal
  std::uint64_t seed = 1;
};

/// What the decoder would give at this pose. T_model_cam: the truth.
inline SurfacePatch make_patch(const SyntheticSurface& surface, const calib::LensValues& camera,
                               const Pose& T_model_cam, const PatchNoise& noise) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  SurfacePatch out;
  out.depth_mm = Map<float>(camera.width, camera.height, kNan);
  out.sigma_mm = out.depth_mm;
  out.points = Map<Vec3f>(camera.width, camera.height, Vec3f::Constant(kNan));
  out.normals = out.points;
  out.texture_dn = Map<float>(camera.width, camera.height, 0.0F);
  out.modulation_dn = Map<float>(camera.width, camera.height, 50.0F);
  const Eigen::Matrix3d R = T_model_cam.linear();
  const double sigma = noise.sigma_mm;
  double start = 48;  // Newton begins at the last pixel's depth
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Vec3d ray = pixel_ray(camera, u, v);
      const Vec3d direction = R * ray;
      const Vec3d p = surface.hit(T_model_cam.translation(), direction, start);
      if (!std::isfinite(p.x())) continue;
      start = R.col(2).dot(p - T_model_cam.translation());
      const std::size_t i = out.depth_mm.index(u, v);
      const std::uint64_t key = mix(noise.seed) + 8 * i;
      const Vec3d normal_model = surface.normal_at(p.x(), p.y());
      const double cosine = -normal_model.dot(direction.normalized());
      out.texture_dn[i] = static_cast<float>(150 * surface.albedo(p.x(), p.y()) * std::max(cosine, 0.0));
      const double z = R.col(2).dot(p - T_model_cam.translation()) + sigma * normal(key);
      if (z < 40 || z > 56 || cosine < 0.17) continue;
      Vec3d n = R.transpose() * normal_model;
      n += noise.normal_rad * Vec3d(normal(key + 1), normal(key + 2), normal(key + 3));
      out.depth_mm[i] = static_cast<float>(z);
      out.sigma_mm[i] = static_cast<float>(std::max(sigma, 1e-4));
      out.points[i] = (z * ray).cast<float>();
      out.normals[i] = n.normalized().cast<float>();
      ++out.valid_px;
    }
  }
  return out;
}

/// The exact surface as the model shows it from a pose; T_model_surface = frame^-1: the model frame is that of `frame`.
inline ModelView view_in_frame(const SyntheticSurface& surface, const calib::LensValues& camera,
                               const Pose& T_surface_cam, const Pose& frame) {
  calib::LensValues ideal = camera;
  ideal.dist = {};
  const SurfacePatch exact = make_patch(surface, ideal, T_surface_cam, {0, 0, 1});
  ModelView view;
  view.T_model_cam = frame.inverse() * T_surface_cam;
  view.points = exact.points;
  view.normals = exact.normals;
  const Eigen::Matrix3f R = view.T_model_cam.linear().cast<float>();
  const Vec3f t = view.T_model_cam.translation().cast<float>();
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    if (!std::isfinite(view.points[i].x())) continue;
    view.points[i] = R * exact.points[i] + t;
    view.normals[i] = R * exact.normals[i];
  }
  view.empty = exact.valid_px == 0;
  return view;
}
inline ModelView make_view(const SyntheticSurface& surface, const calib::LensValues& camera,
                           const Pose& T_surface_cam) {
  return view_in_frame(surface, camera, T_surface_cam, Pose::Identity());
}

/// Distance that two poses put between their images of the point 48 mm before the camera, and the angle between them.
inline double point_error_mm(const Pose& a, const Pose& b) {
  return (a * Vec3d(0, 0, 48) - b * Vec3d(0, 0, 48)).norm();
}
inline double angle_error_rad(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

}  // namespace enamel::testing
