// The axes from drawn corners: planted tilt, skew, harmonics, wobble and noise; against the truth and the stated
// sigmas.
#include "calib/mount/mount_solve.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "calib/target/code_map.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::calib {
namespace {

using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kNoise_px = 0.02;

struct Drawn {
  std::vector<MountStop> stops;
  AxisLine rotation, swing;
};

Eigen::Affine3d about(const AxisLine& l, double angle) {
  const Eigen::Vector3d p(l.point_mm.data()), d(l.direction.data());
  return Eigen::Affine3d(Eigen::Translation3d(p) * Eigen::AngleAxisd(angle, d) * Eigen::Translation3d(-p));
}

AxisLine drawn_line(Rng& rng, const Eigen::Vector3d& along, const Eigen::Vector3d& through) {
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

RigState rig() {
  RigState r;
  r.camera = {.width = 640, .height = 480, .fx = 1707, .fy = 1707, .cx = 318.6, .cy = 241.2, .dist = {}};
  r.projector = r.camera;
  return r;
}

/// Angles beyond those commanded, deg, by stop.
using Beyond = double (*)(std::size_t stop);

Drawn draw(std::uint64_t seed, const TargetDesign& target, Beyond beyond_deg) {
  Rng rng(seed, 0, 13);
  Drawn out;
  out.rotation = drawn_line(rng, {0, 0, -1}, {27, 0, 48});
  out.swing = drawn_line(rng, {0, 1, 0}, {0, 0, 48});
  Eigen::Affine3d board = Eigen::Affine3d::Identity();
  board.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  board.translation() = Eigen::Vector3d(27, 0, 48);
  board = board * Eigen::AngleAxisd(rng.uniform(-3, 3), Eigen::Vector3d::UnitZ());
  const RigState lens = rig();
  std::size_t stop = 0;
  for (const double swing : {-20.0, -10.0, 0.0, 10.0, 20.0}) {
    for (int k = 0; k < 12; ++k, ++stop) {
      MountStop s;
      s.angles.rotation_command = 30.0 * k * kDegree;
      s.angles.swing_command = swing * kDegree;
      const auto angle = [&](const AxisLine& l, double a) {
        return a + 0.01 * kDegree * rng.normal() + l.harmonic_rad[0] * (std::cos(a) - 1) +
               l.harmonic_rad[1] * std::sin(a);
      };
      const double rotation = angle(out.rotation, s.angles.rotation_command) + beyond_deg(stop) * kDegree;
      const Eigen::Affine3d pose =
          about(out.swing, angle(out.swing, s.angles.swing_command)) * about(out.rotation, rotation) * board;
      const Eigen::Vector3d wobble = 0.003 / std::sqrt(3.0) * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
      s.view.name = std::to_string(stop);
      for (int dot = 0; dot < target.size(); ++dot) {
        const Eigen::Vector3d p = pose * target.place(dot) + wobble;
        const double u = lens.camera.fx * p.x() / p.z() + lens.camera.cx,
                     v = lens.camera.fy * p.y() / p.z() + lens.camera.cy;
        if (u < 20 || v < 20 || u > 620 || v > 460) continue;
        DotView d{.dot = dot,
                  .ellipse = {},
                  .covariance_px2 = kNoise_px * kNoise_px * Eigen::Matrix2d::Identity(),
                  .samples = {},
                  .map = {}};
        d.ellipse.centre = {u + kNoise_px * rng.normal(), v + kNoise_px * rng.normal()};
        d.camera_px = d.ellipse.centre;
        s.view.dots.push_back(d);
      }
      out.stops.push_back(std::move(s));
    }
  }
  return out;
}

/// The board as points: centres are drawn, not discs, so that there is no bias to take off.
TargetDesign points() {
  TargetDesign t = parse_target(coded_target_text(make_code_map(40, 40, 1).value(), 1.6, 0.4, 0.2).value()).value();
  t.radius_mm = 0;
  return t;
}

TEST(MountSolve, finds_planted_axes_within_their_sigmas) {
  const TargetDesign target = points();
  int within = 0, all = 0;
  double squares = 0, places = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Drawn d = draw(seed, target, [](std::size_t) { return 0.0; });
    const auto s = solve_mount(d.stops, target, rig());
    ASSERT_TRUE(s) << s.error().message();
    EXPECT_TRUE(s->left_out.empty());
    const std::pair<LineDifference, LineSigma> lines[] = {
        {compare_lines(s->mount.rotation, d.rotation, {0, 0, 48}, 0.1), s->rotation},
        {compare_lines(s->mount.swing, d.swing, {0, 0, 48}, 0.1), s->swing}};
    for (const auto& [error, sigma] : lines) {
      EXPECT_LT(error.angle_rad, 3.5 * sigma.direction_rad);
      squares += std::pow(error.angle_rad / kDegree, 2);
      EXPECT_LT(error.distance_mm, 3.5 * sigma.place_mm);
      places += std::pow(1000 * error.distance_mm, 2);
      std::printf("seed %d: direction %.5f deg (sigma %.5f), place %.2f um (sigma %.2f)\n", static_cast<int>(seed),
                  error.angle_rad / kDegree, sigma.direction_rad / kDegree, 1000 * error.distance_mm,
                  1000 * sigma.place_mm);
      within += error.angle_rad < 2.45 * sigma.direction_rad ? 1 : 0;
      within += error.distance_mm < 2.45 * sigma.place_mm ? 1 : 0;
      all += 2;
    }
  }
  EXPECT_LT(std::sqrt(squares / (all / 2)), 0.003) << "degrees, rms over both lines of all sets";
  EXPECT_LT(std::sqrt(places / (all / 2)), 3) << "um, likewise";
  // Both are lengths in a plane: 95 % lie below 2.45 sigma. 20 draws of which 17 do and more: 98.4 % of all sets.
  EXPECT_GE(within, 17) << "of " << all;
}

TEST(MountSolve, names_a_wrong_stop_and_goes_on) {
  const TargetDesign target = points();
  const Drawn d = draw(7, target, [](std::size_t stop) { return stop == 17 ? 0.4 : 0.0; });
  const auto s = solve_mount(d.stops, target, rig());
  ASSERT_TRUE(s) << s.error().message();
  ASSERT_EQ(s->left_out.size(), 1U);
  EXPECT_EQ(s->left_out[0].pose, "17");
  EXPECT_THAT(s->left_out[0].reason, HasSubstr("table"));
  EXPECT_LT(compare_lines(s->mount.rotation, d.rotation, {0, 0, 48}, 0.1).angle_rad, 3.5 * s->rotation.direction_rad);
}

TEST(MountSolve, refuses_a_table_that_slips) {
  const TargetDesign target = points();
  const Drawn d = draw(8, target, [](std::size_t stop) { return 0.02 * static_cast<double>(stop); });
  const auto s = solve_mount(d.stops, target, rig());
  ASSERT_FALSE(s);
  EXPECT_EQ(s.error().code, ErrorCode::kCalibrationRefused);
  EXPECT_THAT(s.error().detail, HasSubstr("slips"));
}

TEST(MountSolve, refuses_too_few_stops_and_axes_that_cannot_be_told_apart) {
  const TargetDesign target = points();
  Drawn d = draw(9, target, [](std::size_t) { return 0.0; });
  const std::vector<MountStop> one_swing(d.stops.begin(), d.stops.begin() + 12);
  EXPECT_THAT(solve_mount(one_swing, target, rig()).error().detail, HasSubstr("cradle"));
  std::vector<MountStop> bound;  // every angle of the table with one swing only
  for (std::size_t k = 0; k < 12; ++k) bound.push_back(d.stops[12 * (k % 5) + k]);
  EXPECT_THAT(solve_mount(bound, target, rig()).error().detail, HasSubstr("swing alone"));
}

}  // namespace
}  // namespace enamel::calib
