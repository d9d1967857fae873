// A mount drawn by seed and the corners that a rig sees of a coded board on its table: planted tilt, skew, harmonics,
// stop errors, wobble and noise.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "calib/model/lens.hpp"
#include "calib/mount/mount_solve.hpp"
#include "calib/target/code_map.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::calib {

inline constexpr double kDegree = std::numbers::pi / 180;
inline constexpr double kNoise_px = 0.02;

struct Drawn {
  std::vector<MountStop> stops;
  AxisLine rotation, swing;
};

/// Angles beyond those commanded, deg, by stop.
using Beyond = double (*)(std::size_t stop);

struct DrawnStops {
  std::vector<std::array<double, 2>> angles_deg;  ///< rotation, swing
  Beyond beyond_deg = [](std::size_t) { return 0.0; };
  bool has_fringes = false;
};

inline Eigen::Affine3d about(const AxisLine& l, double angle) {
  const Eigen::Vector3d p(l.point_mm.data()), d(l.direction.data());
  return Eigen::Affine3d(Eigen::Translation3d(p) * Eigen::AngleAxisd(angle, d) * Eigen::Translation3d(-p));
}

inline AxisLine drawn_line(Rng& rng, const Eigen::Vector3d& along, const Eigen::Vector3d& through) {
  const double tilt = 2 * kDegree;
  const Eigen::Vector3d off(rng.uniform(-tilt, tilt), rng.uniform(-tilt, tilt), rng.uniform(-tilt, tilt));
  const Eigen::Vector3d d = (along + along.cross(off)).normalized();
  const Eigen::Vector3d p = through + 0.3 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
  AxisLine line;
  line.direction = {d.x(), d.y(), d.z()};
  line.point_mm = {p.x(), p.y(), p.z()};
  line.harmonic_rad = {0.02 * kDegree * rng.uniform(-1, 1), 0.02 * kDegree * rng.uniform(-1, 1)};
  return line;
}

inline RigState rig() {
  RigState r;
  r.camera = {.width = 640, .height = 480, .fx = 1707, .fy = 1707, .cx = 318.6, .cy = 241.2, .dist = {}};
  r.projector = r.camera;
  r.T_proj_cam.linear() = Eigen::AngleAxisd(-0.3, Vec3d::UnitY()).toRotationMatrix();
  r.T_proj_cam.translation() = Vec3d(14, 0, 2);
  return r;
}

inline std::vector<std::array<double, 2>> every(int rotations, const std::vector<double>& swings_deg) {
  std::vector<std::array<double, 2>> out;
  for (const double swing : swings_deg)
    for (int k = 0; k < rotations; ++k) out.push_back({360.0 * k / rotations, swing});
  return out;
}

inline Eigen::Vector2d picture(const LensValues& lens, const Eigen::Vector3d& p) {
  const PlanePoint px = project(lens, {p.x() / p.z(), p.y() / p.z()});
  return {px.x, px.y};
}

/// A dot's coordinates in the projector's picture about its centre, as fringes tell them.
inline void add_samples(DotView& dot, const Eigen::Affine3d& pose, const Eigen::Vector3d& place, const RigState& lens,
                        Rng& rng) {
  constexpr double kStep_mm = 0.1, kFringe_px = 0.05;
  for (int y = -2; y <= 2; ++y) {
    for (int x = -2; x <= 2; ++x) {
      const Eigen::Vector3d p = pose * (place + kStep_mm * Eigen::Vector3d(x, y, 0));
      const Eigen::Vector2d lit = picture(lens.projector, lens.T_proj_cam * p);
      dot.samples.push_back({.camera_px = picture(lens.camera, p),
                             .projector_px = lit + kFringe_px * Eigen::Vector2d(rng.normal(), rng.normal()),
                             .variance_px2 = Eigen::Vector2d::Constant(kFringe_px * kFringe_px)});
    }
  }
}

inline MountStop seen_stop(const Eigen::Affine3d& pose, const Eigen::Vector3d& run_out, const TargetDesign& target,
                           const RigState& lens, bool has_fringes, Rng& rng) {
  MountStop s;
  const Eigen::Affine3d at = Eigen::Translation3d(run_out) * pose;
  for (int dot = 0; dot < target.size(); ++dot) {
    const Eigen::Vector2d px = picture(lens.camera, at * target.place(dot));
    if (px.x() < 20 || px.y() < 20 || px.x() > 620 || px.y() > 460) continue;
    DotView d{.dot = dot,
              .ellipse = {},
              .covariance_px2 = kNoise_px * kNoise_px * Eigen::Matrix2d::Identity(),
              .samples = {},
              .map = {}};
    d.camera_px = px + kNoise_px * Eigen::Vector2d(rng.normal(), rng.normal());
    d.ellipse.centre = {d.camera_px.x(), d.camera_px.y()};
    if (has_fringes) add_samples(d, at, target.place(dot), lens, rng);
    s.view.dots.push_back(d);
  }
  return s;
}

inline Drawn draw(std::uint64_t seed, const TargetDesign& target, const RigState& lens, const DrawnStops& asked) {
  Rng rng(seed, 0, 13);
  Drawn out;
  out.rotation = drawn_line(rng, {0, 0, -1}, {27, 0, 48});
  out.swing = drawn_line(rng, {0, 1, 0}, {0, 0, 48});
  Eigen::Affine3d board = Eigen::Affine3d::Identity();
  board.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  board.translation() = Eigen::Vector3d(27, 0, 48);
  board = board * Eigen::AngleAxisd(rng.uniform(-3, 3), Eigen::Vector3d::UnitZ());
  for (std::size_t stop = 0; stop < asked.angles_deg.size(); ++stop) {
    AxisAngles angles;
    angles.rotation_command = asked.angles_deg[stop][0] * kDegree;
    angles.swing_command = asked.angles_deg[stop][1] * kDegree;
    const auto angle = [&](const AxisLine& l, double a) {
      return a + 0.01 * kDegree * rng.normal() + l.harmonic_rad[0] * (std::cos(a) - 1) +
             l.harmonic_rad[1] * std::sin(a);
    };
    const double rotation = angle(out.rotation, angles.rotation_command) + asked.beyond_deg(stop) * kDegree;
    const Eigen::Affine3d pose =
        about(out.swing, angle(out.swing, angles.swing_command)) * about(out.rotation, rotation) * board;
    const Eigen::Vector3d wobble = 0.003 / std::sqrt(3.0) * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    MountStop s = seen_stop(pose, wobble, target, lens, asked.has_fringes, rng);
    s.angles = angles;
    s.view.name = std::to_string(stop);
    out.stops.push_back(std::move(s));
  }
  return out;
}

/// The board as points: centres are drawn, not discs, so that there is no bias to take off.
inline TargetDesign points(int dots = 40, double pitch_mm = 1.6) {
  TargetDesign t =
      parse_target(coded_target_text(make_code_map(dots, dots, 1).value(), pitch_mm, 0.4, 0.2).value()).value();
  t.radius_mm = 0;
  return t;
}

}  // namespace enamel::calib
