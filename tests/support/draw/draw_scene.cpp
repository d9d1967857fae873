// The scene of a drawn burst, its paint and its motion.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/model/lens.hpp"
#include "tests/support/draw/draw_parts.hpp"

namespace enamel::test {
namespace {

constexpr double kDeg = std::numbers::pi / 180, kTurn = 2 * std::numbers::pi;
constexpr double kReach_mm = 9;  ///< half the side of what is filled with boxes, teeth and stripes

Point3 draw_direction(Random& r) {
  const double z = r(-1, 1), a = r(0, kTurn), s = std::sqrt(1 - z * z);
  return {s * std::cos(a), s * std::sin(a), z};
}

void draw_boxes(Random& r, SceneValues& s) {
  constexpr int kTries = 200;
  const int wanted = r.whole(8, 20);
  const auto apart = [](const Box& a, const Box& b) {
    return std::hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm) >
           std::hypot(a.half_x_mm, a.half_y_mm) + std::hypot(b.half_x_mm, b.half_y_mm);
  };
  for (int k = 0; k < kTries && std::ssize(s.boxes) < wanted; ++k) {
    Box b;
    b.x_mm = r(-kReach_mm, kReach_mm), b.y_mm = r(-kReach_mm, kReach_mm);
    b.half_x_mm = r(0.25, 1.8), b.half_y_mm = r(0.25, 1.8);
    b.height_mm = 0.3 * std::pow(20, r(0, 1));  // 0.3 to 6
    b.turn_rad = r.chance(0.5) ? 0 : r(-45, 45) * kDeg;
    if (std::all_of(s.boxes.begin(), s.boxes.end(), [&](const Box& o) { return apart(b, o); })) s.boxes.push_back(b);
  }
}

void draw_waves(Random& r, double steepness, SceneValues& s) {
  for (int k = 0; k < 4; ++k) {
    const double a = r(0, kTurn), per_mm = kTurn / r(3, 12);
    s.waves.push_back(
        {per_mm * std::cos(a), per_mm * std::sin(a), r(0, kTurn), steepness * r(0.1, 0.4) / std::max(0.5, per_mm)});
  }
}

void draw_teeth(Random& r, SceneValues& s) {
  draw_waves(r, 0.6, s);
  double x = -kReach_mm - r(0, 4);
  const double rise = r(1, 6);
  while (x < kReach_mm) {
    DrawnTooth t;
    t.half_x_mm = r(1.5, 4), t.half_y_mm = r(1.5, 4.5);
    t.x_mm = x + t.half_x_mm, t.y_mm = r(-1, 1);
    t.rise_mm = std::clamp(rise + r(-1.5, 1.5), 0.5, 7.0);
    t.rounding = r(0, 0.6), t.cusp_mm = r.chance(0.5) ? 0 : r(0.05, 0.35);
    t.flank = r.chance(0.4) ? 0 : r(0.02, 0.3);
    x = t.x_mm + t.half_x_mm + (r.chance(0.3) ? r(-0.3, 0) : r(0.1, 2));
    s.teeth.push_back(t);
  }
}

SceneKind draw_shape(Random& r, SceneValues& s) {
  const double which = r(0, 1);
  if (which < 0.2) return SceneKind::kPlane;
  if (which < 0.4) {
    s.balls = {r(1.5, 3.2), r(1.5, 3.2), r(6.5, 9), r(0.5, 1)};
    return SceneKind::kBalls;
  }
  if (which < 0.6) {
    draw_boxes(r, s);
    return SceneKind::kBoxes;
  }
  if (which < 0.85) {
    draw_teeth(r, s);
    return SceneKind::kTeeth;
  }
  draw_waves(r, 1.6, s);
  return SceneKind::kGum;
}

/// What the scene takes along its z.
struct Extent {
  double low_mm = 0, high_mm = 0;
};

Extent extent(const SceneValues& s) {
  Extent e;
  if (s.kind == SceneKind::kBalls) {
    const double r = std::max(s.balls.left_radius_mm, s.balls.right_radius_mm);
    return {-r, r};
  }
  for (const Box& b : s.boxes) e.high_mm = std::max(e.high_mm, b.height_mm);
  for (const DrawnTooth& t : s.teeth) e.high_mm = std::max(e.high_mm, t.rise_mm + t.cusp_mm);
  for (const SurfaceWave& w : s.waves) e.low_mm -= w.height_mm, e.high_mm += w.height_mm;
  return e;
}

Eigen::Isometry3d draw_place(Random& r, const calib::Rig& rig, const SceneValues& s) {
  const Extent e = extent(s);
  const double most_tilt = s.kind == SceneKind::kPlane ? 40 : 25, tilt = most_tilt * r(0, 1) * kDeg,
               about = r(0, kTurn);
  const double front = 43 - 2 * std::sin(tilt), back = 54 - (s.kind == SceneKind::kBalls ? 0 : 2 * std::sin(tilt));
  // z of the scene points back at the camera: what is high is near.
  const double near = front + e.high_mm, far = back + e.low_mm;
  const double z = near < far ? r(near, far) : 0.5 * (near + far);
  const calib::PlanePoint middle =
      calib::undistort(rig.camera, {0.5 * rig.camera.width + r(-20, 20), 0.5 * rig.camera.height + r(-20, 20)});
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const double roll = s.kind == SceneKind::kTeeth ? (r.chance(0.5) ? 0 : 90) + r(-20, 20) : r(-180, 180);
  out.linear() = Eigen::AngleAxisd(tilt, Point3(std::cos(about), std::sin(about), 0)).toRotationMatrix() *
                 Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix() *
                 Eigen::AngleAxisd(roll * kDeg, Point3::UnitZ()).toRotationMatrix();
  Point3 aim = Point3::Zero();  // scene point that the window's middle sees
  if (s.kind == SceneKind::kBalls) aim.x() = r.chance(0.5) ? 0 : (r.chance(0.5) ? 0.5 : -0.5) * s.balls.distance_mm;
  if (s.kind == SceneKind::kTeeth || s.kind == SceneKind::kBoxes) aim = {r(-3, 3), r(-3, 3), 0.5 * e.high_mm};
  out.translation() = z * Point3(middle.x, middle.y, 1) - out.linear() * aim;
  return out;
}

Paint draw_paint(Random& r, SceneKind kind) {
  Paint p;
  p.albedo = r.chance(0.5) ? r(0.5, 0.9) : 0.05 * std::pow(10, r(0, 1));
  for (auto& m : p.mottles) {
    m.per_mm = draw_direction(r) * (kTurn / r(0.6, 6));
    m.phase_rad = r(0, kTurn), m.amount = r.chance(0.3) ? 0 : r(0, 0.1);
  }
  const int stripes = r.chance(0.4) ? 0 : r.whole(1, 4);
  for (int k = 0; k < stripes; ++k)
    p.stripes.push_back({draw_direction(r), r(-5, 5), r(0.15, 2), r.chance(0.8) ? r(0.4, 0.95) : r(0.1, 0.4)});
  if (kind == SceneKind::kTeeth) {
    p.gum_factor = r(0.35, 1);
    p.haze = r.chance(0.3) ? r(0.1, 0.6) : 0;
  }
  return p;
}

DrawnMotion draw_motion(Random& r, const Point3& about) {
  DrawnMotion m;
  if (r.chance(0.2)) return m;
  m.velocity_mm_s = draw_direction(r) * r(0.5, 30);
  if (r.chance(0.7)) m.turn_rad_s = draw_direction(r) * r(0, 20) * kDeg;
  m.pivot_mm = about + Point3(r(-5, 5), r(-5, 5), r(-8, 8));
  return m;
}

}  // namespace

void draw_view(std::uint64_t seed, int attempt, Drawn& drawn) {
  const auto stream = static_cast<std::uint64_t>(attempt) * 16;
  Random shape(seed, stream + 1), place(seed, stream + 2), paint(seed, stream + 3), motion(seed, stream + 4);
  drawn.scene = {};
  drawn.scene.kind = draw_shape(shape, drawn.scene);
  drawn.scene.T_cam_scene = draw_place(place, drawn.rig, drawn.scene);
  drawn.paint = draw_paint(paint, drawn.scene.kind);
  drawn.motion = draw_motion(motion, drawn.scene.T_cam_scene.translation());
}

Drawn draw(std::uint64_t seed, calib::PatternMode mode, int attempt) {
  const auto stream = static_cast<std::uint64_t>(attempt) * 16;
  Random rig(seed, stream + 5), response(seed, stream + 6), optics(seed, stream + 7);
  Drawn out;
  out.seed = seed, out.attempt = attempt;
  out.rig = draw_rig(rig, mode);
  out.response = draw_response(response);
  out.optics = draw_optics(optics);
  draw_view(seed, attempt, out);
  return out;
}

Drawn before_other_scene(const Drawn& drawn, std::uint64_t scene_seed) {
  Drawn out = drawn;
  draw_view(scene_seed, 0, out);
  return out;
}

}  // namespace enamel::test
