// A ring of plaster about the axis of a turning table, whole or in part, as a desktop scanner's stops see it: rays
// against an equation, no twin. Drawn by seed: its size and place, and the mount's lines.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "calib/model/lens.hpp"
#include "calib/model/mount.hpp"
#include "pipeline/register/stops/mount_prior.hpp"
#include "pipeline/types/patch.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::testing {

inline calib::AxisAngles stop_at(double rot_deg, double swing_deg) {
  calib::AxisAngles out;
  out.rotation_command = rot_deg * calib::kRadPerDegree;
  out.swing_command = swing_deg * calib::kRadPerDegree;
  return out;
}

/// A probe of a fourth of the pixels either way: 18 x 13.5 mm at 48 mm, the projector 10 mm beside the camera.
inline calib::Rig ring_rig() {
  calib::Rig rig;
  rig.camera = {.width = 160, .height = 120, .fx = 427, .fy = 427, .cx = 79.5, .cy = 59.5, .dist = {}};
  rig.projector = {.width = 854, .height = 480, .fx = 1602, .fy = 1602, .cx = 427, .cy = 239, .dist = {}};
  const double c = std::cos(0.21), s = std::sin(0.21);
  rig.T_proj_cam = {{{c, 0, s, -9.9}, {0, 1, 0, 0}, {-s, 0, c, 2.3}, {0, 0, 0, 1}}};
  rig.depth_range = calib::DepthRange{40, 56};
  return rig;
}

class RingTable {
 public:
  /// part: of the whole ring, from table angle 0 on.
  explicit RingTable(std::uint64_t seed, double part = 1) : part_(part) {
    Rng rng(seed, 0, 0);
    const auto tilt = [&] { return rng.uniform(-0.03, 0.03); };
    const Vec3d r = Vec3d(tilt(), tilt(), -1).normalized(), s = Vec3d(tilt(), 1, tilt()).normalized();
    mount_.rotation.direction = {r.x(), r.y(), r.z()};
    mount_.rotation.point_mm = {rng.uniform(26, 28), 0, 48};
    mount_.swing.direction = {s.x(), s.y(), s.z()};
    mount_.swing.point_mm = {0, 0, 48};
    radius_ = rng.uniform(25, 28);
    tube_ = rng.uniform(4, 5.5);
    const Vec3d x = Vec3d(1, 0, 0), across = (x - r * r.dot(x)).normalized();
    axes_ << across, r.cross(across), r;
    centre_ = Vec3d(mount_.rotation.point_mm.data());
    const Eigen::Isometry3d T_proj_cam = [&] {
      Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 4; ++j)
          T.matrix()(i, j) = rig_.T_proj_cam[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      }
      return T;
    }();
    T_proj_cam_ = T_proj_cam;
    projector_mm_ = T_proj_cam.inverse().translation();
    rays_ = calib::make_ray_table(rig_.camera);
  }

  [[nodiscard]] const calib::Rig& rig() const { return rig_; }
  [[nodiscard]] const calib::Mount& mount() const { return mount_; }

  [[nodiscard]] SurfacePatch see(const calib::AxisAngles& angles) const {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const Pose T = pipeline::pose_by_axes(mount_, angles);
    SurfacePatch out;
    out.depth_mm = out.sigma_mm = Map<float>(rays_.width, rays_.height, kNan);
    out.points = out.normals = Map<Vec3f>(rays_.width, rays_.height, Vec3f::Constant(kNan));
    for (std::size_t i = 0; i < out.points.size(); ++i) {
      const Vec3d ray(static_cast<double>(rays_.x[i]), static_cast<double>(rays_.y[i]), 1);
      const auto z = trace(T.translation(), T.linear() * ray, 38, 58);
      if (!z) continue;
      const Vec3d p = T * (*z * ray), n = normal(p);
      if (!shows(T, p, n, kLeastCos)) continue;
      out.points[i] = (*z * ray).cast<float>();
      out.normals[i] = (T.linear().transpose() * n).cast<float>();
      out.depth_mm[i] = static_cast<float>(*z);
      out.sigma_mm[i] = 0.01F;
      ++out.valid_px;
    }
    return out;
  }

  struct Sample {
    Vec3d point, normal;
  };
  /// Of equal steps about ring and tube.
  [[nodiscard]] std::vector<Sample> samples() const {
    std::vector<Sample> out;
    constexpr int kRound = 240, kTube = 40;
    for (int i = 0; i < kRound; ++i) {
      const double a = 2 * std::numbers::pi * (i + 0.5) / kRound;
      if ((i + 0.5) / kRound > part_) continue;
      for (int j = 0; j < kTube; ++j) {
        const double b = 2 * std::numbers::pi * (j + 0.5) / kTube;
        const Vec3d n(std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b));
        const Vec3d q = Vec3d(radius_ * std::cos(a), radius_ * std::sin(a), 0) + tube_ * n;
        out.push_back({centre_ + axes_ * q, axes_ * n});
      }
    }
    return out;
  }
  [[nodiscard]] bool shows(const calib::AxisAngles& angles, const Sample& s, double max_incidence_deg) const {
    return shows(pipeline::pose_by_axes(mount_, angles), s.point, s.normal,
                 std::cos(max_incidence_deg * calib::kRadPerDegree));
  }

 private:
  static constexpr double kLeastCos = 0.26;

  [[nodiscard]] double distance(const Vec3d& p) const {
    const Vec3d q = axes_.transpose() * (p - centre_);
    return std::hypot(q.head<2>().norm() - radius_, q.z()) - tube_;
  }
  [[nodiscard]] Vec3d normal(const Vec3d& p) const {
    const Vec3d q = axes_.transpose() * (p - centre_);
    const double round = q.head<2>().norm();
    return axes_ * Vec3d(q - Vec3d(q.x(), q.y(), 0) * (radius_ / round)).normalized();
  }
  [[nodiscard]] bool is_there(const Vec3d& p) const {
    const Vec3d q = axes_.transpose() * (p - centre_);
    const double a = std::atan2(q.y(), q.x()) / (2 * std::numbers::pi);
    return (a < 0 ? a + 1 : a) <= part_;
  }
  /// Parameter of the hit; steps as long as the distance allows.
  [[nodiscard]] std::optional<double> trace(const Vec3d& from, const Vec3d& along, double near, double far) const {
    const double length = along.norm();
    double t = near;
    for (int n = 0; n < 60 && t < far; ++n) {
      const double d = distance(from + t * along);
      if (d < 1e-4) return is_there(from + t * along) ? std::optional<double>(t) : std::nullopt;
      t += d / length;
    }
    return std::nullopt;
  }
  [[nodiscard]] static bool in_picture(const calib::LensValues& lens, const Vec3d& p) {
    if (p.z() < 1) return false;
    const calib::PlanePoint px = calib::project(lens, {p.x() / p.z(), p.y() / p.z()});
    return px.x > -0.5 && px.y > -0.5 && px.x < lens.width - 0.5 && px.y < lens.height - 0.5;
  }
  [[nodiscard]] bool shows(const Pose& T, const Vec3d& point, const Vec3d& n, double least_cos) const {
    const Vec3d p = T.inverse() * point, eye = T.translation(), light = T * projector_mm_;
    if (p.z() < 40 || p.z() > 56 || !in_picture(rig_.camera, p) || !in_picture(rig_.projector, T_proj_cam_ * p))
      return false;
    if (n.dot((eye - point).normalized()) < least_cos || n.dot((light - point).normalized()) < least_cos) return false;
    const Vec3d off = point + 0.02 * n;
    return !trace(off, (eye - off).normalized(), 0, 30) && !trace(off, (light - off).normalized(), 0, 30);
  }

  double part_, radius_ = 0, tube_ = 0;
  calib::Rig rig_ = ring_rig();
  calib::Mount mount_;
  Eigen::Matrix3d axes_;
  Vec3d centre_, projector_mm_;
  Eigen::Isometry3d T_proj_cam_;
  calib::RayTable rays_;
};

}  // namespace enamel::testing
