// A mount's kinematics against cases worked out by hand, and the errors that are planted.
#include "tools/twin/mount/mount.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/degrees.hpp"
#include "tools/twin/mount/mount_path.hpp"

namespace enamel::twin::testing {
namespace {

using Eigen::Vector3d;

void expect_at(const Vector3d& got, const Vector3d& want) { EXPECT_LT((got - want).norm(), 1e-12) << got.transpose(); }

/// Rotation about z, swing about x, both through the origin; table and model frame are the camera's.
MountConfig plain() {
  MountConfig c;
  c.rotation.direction = {0, 0, 1};
  c.rotation.point_mm = {0, 0, 0};
  c.swing.direction = {1, 0, 0};
  c.swing.point_mm = {5, 0, 0};
  return c;
}

MountRun run_to(MountConfig c, double rot_deg, double swing_deg) {
  c.stops = {{rot_deg, swing_deg}};
  return drive(c, 1);
}

Vector3d in_camera(const MountRun& run, const Vector3d& p) { return T_camera_table(run.mount, run.stops[0]) * p; }

TEST(MountKinematics, a_turn_is_right_handed_and_keeps_its_line) {
  expect_at(turn_about({0, 0, 1}, {0, 0, 0}, 0.5 * kPi) * Vector3d(1, 0, 0), {0, 1, 0});
  expect_at(turn_about({0, 0, 2}, {1, 0, 9}, 0.5 * kPi) * Vector3d(2, 0, 3), {1, 1, 3});
  expect_at(turn_about({0, 0, -1}, {0, 0, 0}, 0.5 * kPi) * Vector3d(1, 0, 0), {0, -1, 0});
  expect_at(turn_about({1, 1, 1}, {1, 2, 3}, 2 * kPi / 3) * Vector3d(2, 2, 3), {1, 3, 3});
  expect_at(turn_about({0, 1, 0}, {4, 0, 5}, 1.234) * Vector3d(4, 7, 5), {4, 7, 5});
}

TEST(MountKinematics, the_cradle_swings_the_table_that_has_turned) {
  const MountRun run = run_to(plain(), 90, 90);
  expect_at(in_camera(run, {1, 0, 0}), {0, 0, 1});
  // Swung first and turned about the fixed axis it would be here.
  EXPECT_GT((in_camera(run, {1, 0, 0}) - Vector3d(0, 1, 0)).norm(), 1.0);
  expect_at(in_camera(run_to(plain(), 90, 0), {1, 0, 2}), {0, 1, 2});
  expect_at(in_camera(run_to(plain(), 0, 90), {1, 1, 0}), {1, 0, 1});
}

TEST(MountKinematics, the_table_frame_stands_on_the_rotation_axis_and_faces_the_head) {
  const MountRun run = run_to(MountConfig{}, 0, 0);  // axis towards the head at x = 27, swing through the field along y
  expect_at(in_camera(run, {0, 0, 0}), {27, 0, 48});
  expect_at(in_camera(run, {27, 0, 4}), {0, 0, 44});
  expect_at(in_camera(run, {0, 1, 0}), {27, 1, 48});
  // What lies under the head on the axis of the cradle stays there.
  expect_at(in_camera(run_to(MountConfig{}, 0, 20), {27, 3, 0}), {0, 3, 48});
}

TEST(MountKinematics, the_model_stands_where_it_was_put) {
  MountConfig c = plain();
  c.place_mm = {10, 0, 1};
  c.place_turn_deg = 90;
  const MountRun run = run_to(c, 90, 0);
  const Vector3d at = T_model_camera(run.mount, run.stops[0]).inverse() * Vector3d(2, 0, 0);
  expect_at(at, {-2, 10, 1});
}

TEST(MountKinematics, the_first_harmonic_is_none_at_zero_and_as_stated_elsewhere) {
  MountConfig c = plain();
  c.rotation.harmonic_deg = {0.03, 0.05};
  c.swing.harmonic_deg = {0.5, -0.4};
  const auto rot_deg = [&](double a) { return run_to(c, a, 0).stops[0].rot / kRadPerDeg; };
  EXPECT_NEAR(rot_deg(0), 0, 1e-12);
  EXPECT_NEAR(rot_deg(90), 90 - 0.03 + 0.05, 1e-12);
  EXPECT_NEAR(rot_deg(180), 180 - 0.06, 1e-12);
  EXPECT_NEAR(rot_deg(270), 270 - 0.03 - 0.05, 1e-12);
  const StopTruth swung = run_to(c, 0, -30).stops[0];
  EXPECT_NEAR(swung.swing / kRadPerDeg, -30 + 0.5 * (std::sqrt(0.75) - 1) + 0.4 * 0.5, 1e-12);
  EXPECT_NEAR(swung.swing_shaft / kRadPerDeg, -30, 1e-12);
}

std::vector<double> misses_deg(Approach approach) {
  MountConfig c = plain();
  c.rotation.backlash_deg = 0.04;
  c.rotation.approach = approach;
  for (const double a : {0.0, 30.0, 10.0, 10.0, 5.0, 20.0}) c.stops.push_back({a, 0});
  std::vector<double> out;
  for (const StopTruth& s : drive(c, 1).stops) {
    out.push_back((s.rot - s.rot_cmd) / kRadPerDeg);
    EXPECT_EQ(s.swing, 0.0);
  }
  return out;
}

TEST(MountDrive, the_table_lags_behind_a_falling_angle_and_only_there) {
  const std::vector<double> want{0, 0, 0.04, 0.04, 0.04, 0};
  const std::vector<double> got = misses_deg(Approach::kNearest);
  for (std::size_t i = 0; i < want.size(); ++i) EXPECT_NEAR(got[i], want[i], 1e-12) << i;
  for (const double miss : misses_deg(Approach::kPositive)) EXPECT_NEAR(miss, 0, 1e-12);
}

TEST(MountDrive, stop_errors_have_their_rms_and_a_resting_axis_keeps_its_own) {
  MountConfig c = plain();
  c.rotation.stop_error_deg = 0.02;
  c.swing.stop_error_deg = 0.05;
  constexpr int kStops = 4000;
  for (int i = 0; i < kStops; ++i) c.stops.push_back({0.01 * i, i < kStops / 2 ? 0.0 : 10.0});
  const MountRun run = drive(c, 7);
  double squares = 0;
  for (const StopTruth& s : run.stops) {
    squares += std::pow((s.rot_shaft - s.rot_cmd) / kRadPerDeg, 2);
    const StopTruth& like = s.swing_cmd == 0 ? run.stops.front() : run.stops.back();
    EXPECT_EQ(s.swing_shaft, like.swing_shaft);
  }
  EXPECT_NEAR(std::sqrt(squares / kStops), 0.02, 5 * 0.02 / std::sqrt(2.0 * kStops));
  EXPECT_NE(run.stops.front().swing_shaft, run.stops.back().swing_shaft - 10 * kRadPerDeg);
}

TEST(MountDrive, the_table_runs_out_twice_a_turn) {
  MountConfig c = plain();
  c.wobble_um = 3;
  for (const double a : {0.0, 90.0, 180.0, 45.0, 225.0}) c.stops.push_back({a, 0});
  const auto stops = drive(c, 3).stops;
  const auto off = [&](std::size_t i) { return stops[i].run_out_mm; };
  EXPECT_LT((off(0) - off(2)).norm(), 1e-12);
  EXPECT_LT((off(0) + off(1)).norm(), 1e-12);
  EXPECT_LT((off(3) - off(4)).norm(), 1e-12);
  // Quadrature: cos² + sin² an axis.
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::hypot(off(0)[k], off(3)[k]), 0.003, 1e-12);
  const MountRun run{drive(c, 3).mount, stops};
  expect_at(in_camera(run, {0, 0, 0}), off(0));
}

/// Distance of the two axes, by their common perpendicular.
double skew(const Mount& m) {
  const Vector3d n = m.rotation.direction.cross(m.swing.direction).normalized();
  return n.dot(m.swing.point_mm - m.rotation.point_mm);
}

TEST(MountDraw, a_units_errors_lie_within_their_bounds_and_fill_them) {
  MountConfig c = plain();
  c.swing.point_mm = {0, 0, 0};
  c.draw = true;
  double tilt = 0, apart = 0, harmonic = 0, backlash = 0, wobble = 0, tilts = 0;
  constexpr int kSeeds = 400;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Mount m = drive(c, seed).mount;
    const double tilt_deg = std::acos(m.rotation.direction.z()) / kRadPerDeg;
    tilts += tilt_deg / kSeeds;
    tilt = std::max({tilt, tilt_deg, std::acos(m.swing.direction.x()) / kRadPerDeg});
    apart = std::max(apart, std::abs(skew(m)));
    for (const Axis* a : {&m.rotation, &m.swing}) {
      harmonic = std::max(harmonic, std::hypot(a->harmonic_rad[0], a->harmonic_rad[1]) / kRadPerDeg);
      backlash = std::max(backlash, a->backlash_rad / kRadPerDeg);
    }
    wobble = std::max(wobble, 1e3 * m.wobble_mm);
  }
  const auto expect_filled = [](double most, double bound) {
    EXPECT_LE(most, bound * (1 + 1e-9));
    EXPECT_GT(most, 0.97 * bound);
  };
  expect_filled(tilt, 2);
  expect_filled(apart, 0.3);
  expect_filled(harmonic, 0.02);
  expect_filled(backlash, 0.05);
  expect_filled(wobble, 3);
  EXPECT_NEAR(tilts, 1.0, 5 * 2 / std::sqrt(12.0 * kSeeds));
}

TEST(MountDraw, nothing_is_drawn_unless_asked_for_and_every_seed_is_a_unit_of_its_own) {
  MountConfig c = plain();
  const Mount exact = drive(c, 5).mount;
  EXPECT_EQ(exact.rotation.direction, Vector3d(0, 0, 1));
  EXPECT_EQ(exact.wobble_mm, 0.0);
  EXPECT_NEAR(skew(exact), 0, 1e-12);
  c.draw = true;
  EXPECT_EQ(drive(c, 5).mount.rotation.direction, drive(c, 5).mount.rotation.direction);
  EXPECT_GT((drive(c, 5).mount.rotation.direction - drive(c, 6).mount.rotation.direction).norm(), 1e-4);
}

TEST(MountDraw, stated_errors_are_in_force_without_a_draw) {
  MountConfig c = plain();
  c.swing.point_mm = {0, 0, 0};
  c.skew_mm = -0.25;
  c.rotation.tilt_deg = {1.5, 0, 0};
  const Mount m = drive(c, 1).mount;
  EXPECT_NEAR(skew(m), -0.25, 1e-12);
  expect_at(m.rotation.direction, {0, -std::sin(1.5 * kRadPerDeg), std::cos(1.5 * kRadPerDeg)});
}

}  // namespace
}  // namespace enamel::twin::testing
