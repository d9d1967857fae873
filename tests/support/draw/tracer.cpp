#include "tests/support/draw/tracer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace enamel::test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kReference_mm = 44, kReferenceAlbedo = 0.8;  ///< where the exposure is stated

/// sin of the mottles' waves by table: they are asked for in every sample.
double wave(double x_rad) {
  constexpr int kPoints = 1024;
  static const std::array<double, kPoints + 1> kTable = [] {
    std::array<double, kPoints + 1> t{};
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = std::sin(kTurn * static_cast<double>(i) / kPoints);
    return t;
  }();
  const double turns = x_rad / kTurn, x = (turns - std::floor(turns)) * kPoints;
  const auto i = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(kPoints - 1));
  return kTable[i] + (x - static_cast<double>(i)) * (kTable[i + 1] - kTable[i]);
}

struct Painted {
  double albedo = 0;
  int field = 0;  ///< which of the sharp stripes are here
};

Painted paint_at(const Paint& paint, const Point3& p, bool gum) {
  double factor = 1;
  for (const auto& m : paint.mottles)
    if (m.amount > 0) factor += m.amount * wave(m.per_mm.dot(p) + m.phase_rad);
  Painted out;
  for (const auto& s : paint.stripes) {
    out.field *= 2;
    if (std::abs(s.normal.dot(p) - s.offset_mm) < s.half_width_mm) factor *= s.factor, out.field += 1;
  }
  if (gum) factor *= paint.gum_factor;
  out.albedo = std::clamp(paint.albedo * factor, 0.005, 0.95);
  return out;
}

Eigen::Isometry3d projector_from_camera(const calib::Rig& rig) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    const auto& row = rig.T_proj_cam[static_cast<std::size_t>(i)];
    for (int j = 0; j < 3; ++j) out.linear()(i, j) = row[static_cast<std::size_t>(j)];
    out.translation()(i) = row[3];
  }
  return out;
}

}  // namespace

Tracer::Tracer(const Drawn& drawn, const SceneShape& shape, double time_s) : drawn_(drawn), shape_(shape) {
  const Eigen::Isometry3d scene_from_camera = (drawn.motion.at(time_s) * drawn.scene.T_cam_scene).inverse();
  to_scene_ = scene_from_camera.linear();
  camera_ = scene_from_camera.translation();
  projector_ = scene_from_camera * projector_from_camera(drawn.rig).inverse().translation();
  strength_ = drawn.optics.exposure * kReference_mm * kReference_mm / kReferenceAlbedo;
}

TracedPoint Tracer::trace(calib::PlanePoint ray) const {
  TracedPoint out;
  const SceneRay through{camera_, to_scene_ * Point3(ray.x, ray.y, 1)};
  const SceneHit hit = shape_.hit(through);
  if (!std::isfinite(hit.at)) return out;
  const Point3 p = through.origin + hit.at * through.direction;
  const Painted painted = paint_at(drawn_.paint, p, hit.gum);
  const calib::LensValues& lens = drawn_.rig.projector;
  const auto& t = drawn_.rig.T_proj_cam;
  Point3 q;  // before the projector
  for (int i = 0; i < 3; ++i) {
    const auto& row = t[static_cast<std::size_t>(i)];
    q(i) = hit.at * (row[0] * ray.x + row[1] * ray.y + row[2]) + row[3];
  }
  const calib::PlanePoint pixel = calib::project(lens, {q.x() / q.z(), q.y() / q.z()});
  out.depth_mm = hit.at;
  out.column_px = pixel.x;
  out.projector_depth_mm = q.z();
  out.ambient = drawn_.optics.ambient * painted.albedo;
  out.face = hit.face * 64 + painted.field;
  const Point3 to_light = projector_ - p;
  const double cosine = hit.normal.dot(to_light);
  const bool inside =
      q.z() > 0 && pixel.x > -0.5 && pixel.y > -0.5 && pixel.x < lens.width - 0.5 && pixel.y < lens.height - 0.5;
  if (!inside || cosine <= 0 || shape_.blocks(p, hit, projector_)) return out;
  const double r2 = to_light.squaredNorm(), projector_cos2 = q.z() * q.z() / r2;
  const double camera_cos2 = 1 / (1 + ray.x * ray.x + ray.y * ray.y);
  out.lit = true;
  out.light = strength_ * painted.albedo * cosine / std::sqrt(r2) / r2 * projector_cos2 * projector_cos2 * camera_cos2 *
              camera_cos2;
  return out;
}

}  // namespace enamel::test
