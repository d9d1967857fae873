#include "tools/twin/mount/mount.hpp"

#include <cmath>
#include <numbers>

#include "tools/twin/degrees.hpp"
#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// Streams of the random numbers: the unit's errors, its wobble, where the two drives stop.
constexpr std::uint64_t kUnitStream = 7300, kWobbleStream = 7301, kRotStopStream = 7302, kSwingStopStream = 7303;
// Once a turn would be nothing but another centre of the table.
constexpr double kWobblesPerTurn = 2;

Vector3d to_eigen(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

Vector3d turned(const Vector3d& direction, const Vector3d& turn_rad) {
  const double angle = turn_rad.norm();
  if (angle == 0) return direction.normalized();
  return Eigen::AngleAxisd(angle, turn_rad / angle) * direction.normalized();
}

/// Adds a tilt of up to kDrawnTilt_deg to any side and a first harmonic of any phase.
void draw_axis(AxisConfig& axis, const CounterRandom& random, std::uint64_t& draw) {
  const Vector3d along = stated_direction(axis);
  const double tilt_deg = random.uniform(draw++, 0, kDrawnTilt_deg);
  const double azimuth = random.uniform(draw++, 0, 2 * std::numbers::pi);
  const Vector3d across = Eigen::AngleAxisd(azimuth, along) * along.unitOrthogonal();
  const Vector3d tilted = turned(along, kRadPerDeg * tilt_deg * across);
  axis.direction = {tilted.x(), tilted.y(), tilted.z()};
  axis.tilt_deg = {};
  const double amplitude_deg = random.uniform(draw++, 0, kDrawnHarmonic_deg);
  const double phase = random.uniform(draw++, 0, 2 * std::numbers::pi);
  axis.harmonic_deg[0] += amplitude_deg * std::cos(phase);
  axis.harmonic_deg[1] += amplitude_deg * std::sin(phase);
  axis.backlash_deg += random.uniform(draw++, 0, kDrawnBacklash_deg);
}

Axis axis_of(const AxisConfig& c) {
  Axis axis;
  axis.direction = stated_direction(c);
  axis.point_mm = to_eigen(c.point_mm);
  axis.harmonic_rad = {kRadPerDeg * c.harmonic_deg[0], kRadPerDeg * c.harmonic_deg[1]};
  axis.backlash_rad = kRadPerDeg * c.backlash_deg;
  axis.approach = c.approach;
  return axis;
}

Isometry3d table_at_zero(const Axis& rotation, const Axis& swing) {
  const Vector3d z = rotation.direction, to_swing = swing.point_mm - rotation.point_mm;
  const Vector3d across = to_swing - z * z.dot(to_swing);
  // Where the swing axis's point lies on the rotation axis any side will do.
  constexpr double kTiny_mm = 1e-6;
  const Vector3d x = across.norm() > kTiny_mm ? Vector3d(across.normalized()) : z.unitOrthogonal();
  Isometry3d T = Isometry3d::Identity();
  T.linear() << x, z.cross(x), z;
  T.translation() = rotation.point_mm;
  return T;
}

Mount mount_of(const MountConfig& c, std::uint64_t seed) {
  Mount m;
  m.rotation = axis_of(c.rotation);
  m.swing = axis_of(c.swing);
  m.swing.point_mm += c.skew_mm * m.rotation.direction.cross(m.swing.direction).normalized();
  m.wobble_mm = kMmPerUm * c.wobble_um;
  const CounterRandom random(seed, kWobbleStream);
  for (std::size_t i = 0; i < 3; ++i) m.wobble_phase_rad[i] = random.uniform(i, 0, 2 * std::numbers::pi);
  m.T_camera_table = table_at_zero(m.rotation, m.swing);
  m.T_table_model.translate(to_eigen(c.place_mm));
  m.T_table_model.rotate(Eigen::AngleAxisd(kRadPerDeg * c.place_turn_deg, Vector3d::UnitZ()));
  return m;
}

double with_harmonic(const Axis& axis, double shaft_rad) {
  const auto [hc, hs] = axis.harmonic_rad;
  return shaft_rad + hc * (std::cos(shaft_rad) - 1) + hs * std::sin(shaft_rad);
}

/// One drive on its way from stop to stop.
class Shaft {
 public:
  Shaft(const Axis& axis, bool is_swing, double stop_error_deg, std::uint64_t seed)
      : axis_(axis), is_swing_(is_swing), error_deg_(stop_error_deg), seed_(seed) {}

  double go_to(double command_rad) {
    const bool moves = !has_stopped_ || command_rad != command_rad_;
    if (moves) {
      // The first stop is reached from the end switch below.
      const bool falls = has_stopped_ && command_rad < command_rad_;
      const double lag = falls && axis_.approach == Approach::kNearest ? axis_.backlash_rad : 0;
      off_rad_ = lag + stop_error_rad(is_swing_, error_deg_, seed_, moves_++);
    }
    has_stopped_ = true;
    command_rad_ = command_rad;
    return command_rad + off_rad_;
  }

 private:
  const Axis& axis_;
  bool is_swing_;
  double error_deg_;
  std::uint64_t seed_;
  std::uint64_t moves_ = 0;
  bool has_stopped_ = false;
  double command_rad_ = 0, off_rad_ = 0;
};

/// Run-out of the table's bearing in the table's frame at angle 0, an axis of which is w cos(2 a + phase).
Vector3d run_out(const Mount& m, double rot_rad) {
  Vector3d out;
  for (std::size_t i = 0; i < 3; ++i) {
    out[static_cast<Eigen::Index>(i)] = m.wobble_mm * std::cos(kWobblesPerTurn * rot_rad + m.wobble_phase_rad[i]);
  }
  return m.T_camera_table.linear() * out;
}

}  // namespace

Vector3d stated_direction(const AxisConfig& axis) {
  return turned(to_eigen(axis.direction), kRadPerDeg * to_eigen(axis.tilt_deg));
}

MountConfig drawn(const MountConfig& config, std::uint64_t seed) {
  MountConfig out = config;
  if (!config.draw) return out;
  const CounterRandom random(seed, kUnitStream);
  std::uint64_t draw = 0;
  draw_axis(out.rotation, random, draw);
  draw_axis(out.swing, random, draw);
  out.skew_mm += random.uniform(draw++, -kDrawnSkew_mm, kDrawnSkew_mm);
  out.wobble_um += random.uniform(draw++, 0, kDrawnWobble_um);
  return out;
}

double stop_error_rad(bool is_swing, double rms_deg, std::uint64_t seed, std::uint64_t movement) {
  const CounterRandom random(seed, is_swing ? kSwingStopStream : kRotStopStream);
  return kRadPerDeg * rms_deg * random.normals(movement).a;
}

StopTruth table_at(const Mount& mount, const std::array<double, 2>& shaft_rad) {
  StopTruth t;
  t.rot_shaft = shaft_rad[0];
  t.swing_shaft = shaft_rad[1];
  t.rot = with_harmonic(mount.rotation, t.rot_shaft);
  t.swing = with_harmonic(mount.swing, t.swing_shaft);
  t.run_out_mm = run_out(mount, t.rot);
  return t;
}

MountRun drive(const MountConfig& stated, std::uint64_t seed) {
  const MountConfig config = drawn(stated, seed);
  MountRun run;
  run.mount = mount_of(config, seed);
  Shaft rotation(run.mount.rotation, false, config.rotation.stop_error_deg, seed);
  Shaft swing(run.mount.swing, true, config.swing.stop_error_deg, seed);
  for (const MountStop& stop : config.stops) {
    const double rot_cmd = kRadPerDeg * stop.rot_deg, swing_cmd = kRadPerDeg * stop.swing_deg;
    StopTruth t = table_at(run.mount, {rotation.go_to(rot_cmd), swing.go_to(swing_cmd)});
    t.rot_cmd = rot_cmd;
    t.swing_cmd = swing_cmd;
    run.stops.push_back(t);
  }
  return run;
}

Isometry3d turn_about(const Vector3d& direction, const Vector3d& point_mm, double angle_rad) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(angle_rad, direction.normalized()).toRotationMatrix();
  T.translation() = point_mm - T.linear() * point_mm;
  return T;
}

Isometry3d T_camera_table(const Mount& m, const StopTruth& stop) {
  return turn_about(m.swing.direction, m.swing.point_mm, stop.swing) * Eigen::Translation3d(stop.run_out_mm) *
         turn_about(m.rotation.direction, m.rotation.point_mm, stop.rot) * m.T_camera_table;
}

Isometry3d T_model_camera(const Mount& m, const StopTruth& stop) {
  return (T_camera_table(m, stop) * m.T_table_model).inverse();
}

}  // namespace enamel::twin
