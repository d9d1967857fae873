// Self-check of a rig from a scan: a relief seen from many sides, by a rig that reads its depths as a drifted one does.
#include "calib/judge/drift.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "protocol/base/rng.hpp"

namespace enamel::calib {
namespace {

constexpr LensValues kCamera{.width = 240, .height = 180, .fx = 640, .fy = 640, .cx = 119.5, .cy = 89.5, .dist = {}};

/// Relief z = h(x, y), some 2.4 mm from top to bottom, and its gradient.
struct Relief {
  double z = 0, dx = 0, dy = 0;
};
Relief relief(double x, double y) {
  constexpr double kX = 2 * std::numbers::pi / 9, kY = 2 * std::numbers::pi / 7, kD = 2 * std::numbers::pi / 4;
  const double a = kX * x, b = kY * y, c = kD * (0.6 * x + 0.8 * y);
  return {0.8 * std::sin(a) + 0.6 * std::cos(b) + 0.1 * std::sin(c), 0.8 * kX * std::cos(a) + 0.06 * kD * std::cos(c),
          -0.6 * kY * std::sin(b) + 0.08 * kD * std::cos(c)};
}

/// The probe 48 mm above (x, y), tilted about its x axis, rolled about its own axis; camera z looks at the relief.
Pose stand(double x_mm, double y_mm, double tilt_deg, double roll_deg) {
  constexpr double kRad = std::numbers::pi / 180;
  Pose pose = Pose::Identity();
  pose.linear() =
      (Eigen::AngleAxisd(std::numbers::pi, Vec3d::UnitX()) * Eigen::AngleAxisd(tilt_deg * kRad, Vec3d::UnitX()) *
       Eigen::AngleAxisd(roll_deg * kRad, Vec3d::UnitZ()))
          .toRotationMatrix();
  pose.translation() = Vec3d(x_mm, y_mm, 0) - pose.linear() * Vec3d(0, 0, 48);
  return pose;
}

SurfaceCell measured(const Pose& T_model_cam, const Vec3d& ray, const DriftVector& theta, Rng& rng) {
  double z = 48;
  Vec3d normal;
  for (int k = 0; k < 12; ++k) {  // Newton along the ray
    const Vec3d p = T_model_cam * Vec3d(ray * z), along = T_model_cam.linear() * ray;
    const Relief h = relief(p.x(), p.y());
    normal = Vec3d(-h.dx, -h.dy, 1);
    z -= (p.z() - h.z) / normal.dot(along);
  }
  constexpr float kNoise_mm = 0.006F;
  const double read = 1 / (1 / z + drift_basis(ray).dot(theta)) + static_cast<double>(kNoise_mm) * rng.normal();
  return {(ray * read).cast<float>(), (T_model_cam.linear().transpose() * normal.normalized()).cast<float>(), kNoise_mm,
          0};
}

struct Scan {
  bool has_sides = true;  ///< three passes that look from three sides, and turns; else one pass straight down
  double truth_um[kDriftModes] = {};
};

/// um at 48 mm as DriftFigure states them, to theta.
DriftVector theta_of(const double (&um)[kDriftModes]) {
  DriftVector theta;
  for (int m = 0; m < kDriftModes; ++m) theta[m] = um[m] * 1e-3 / (m == 0 ? 48. * 48 : m < 3 ? 48. * 8 : 64.);
  return theta;
}

std::vector<DriftView> scanned(const Scan& scan, std::uint64_t seed) {
  Rng rng(seed, 2, 3);
  const DriftVector theta = theta_of(scan.truth_um);
  std::vector<DriftView> views;
  for (int i = 0; i < 21; ++i) {
    const int pass = i / 7, at = i % 7;
    const double tilt = scan.has_sides ? 35. * (pass - 1) : 0, roll = scan.has_sides ? 30. * (at % 4) : 0;
    const Pose truth = stand(2.0 * at, scan.has_sides ? 0 : 2. * pass, tilt + rng.normal(), roll + rng.normal());
    DriftView view{{kCamera.width / kDriftCell_px, kCamera.height / kDriftCell_px}, truth};
    for (int v = 0; v < view.cells.height(); ++v) {
      for (int u = 0; u < view.cells.width(); ++u) {
        const Vec3d ray((kDriftCell_px * u + 0.5 - kCamera.cx) / kCamera.fx,
                        (kDriftCell_px * v + 0.5 - kCamera.cy) / kCamera.fy, 1);
        view.cells(u, v) = measured(truth, ray, theta, rng);
      }
    }
    fill_depths_around(view);
    view.T_model_cam.translation() += 0.02 * Vec3d(rng.normal(), rng.normal(), rng.normal());
    view.T_model_cam.linear() *= Eigen::AngleAxisd(3e-4 * rng.normal(), Vec3d::UnitX()).toRotationMatrix();
    views.push_back(std::move(view));
  }
  return views;
}

DriftCheck check(const Scan& scan, std::uint64_t seed) {
  const auto found = check_drift(scanned(scan, seed), kCamera, {.overlap = {.stride = 3}});
  EXPECT_TRUE(found) << found.error().message();
  return *found;
}

std::string told(const DriftCheck& c) {
  std::string text;
  for (const auto& f : c.figures)
    text += std::string(f.name) + " " + std::to_string(f.um) + " +- " + std::to_string(f.sigma_um) + "\n";
  return text + std::to_string(c.rms_before_um) + " -> " + std::to_string(c.rms_after_um) + " um, pairs " +
         std::to_string(c.pairs);
}

TEST(Drift, true_rig_raises_no_alarm) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const DriftCheck c = check({}, seed);
    EXPECT_FALSE(c.is_alarm()) << told(c);
    EXPECT_THAT(c.blind(), testing::IsEmpty()) << told(c);
  }
}

TEST(Drift, planted_drift_raises_the_alarm_and_is_found_in_its_size) {
  const std::array<Scan, 4> scans{Scan{.truth_um = {40, 0, 0, 0, 0, 0}}, Scan{.truth_um = {0, 30, -30, 0, 0, 0}},
                                  Scan{.truth_um = {0, 0, 0, 4, -4, 4}}, Scan{.truth_um = {0, 0, 0, 0, 2, 0}}};
  for (const Scan& scan : scans) {
    const DriftCheck c = check(scan, 10);
    EXPECT_LT(c.rms_after_um, c.rms_before_um);
    for (std::size_t m = 0; m < kDriftModes; ++m) {
      SCOPED_TRACE(c.figures[m].name);
      EXPECT_EQ(c.figures[m].is_alarm, scan.truth_um[m] != 0) << told(c);
      EXPECT_NEAR(c.figures[m].um, scan.truth_um[m], 5 * c.figures[m].sigma_um + 0.02 * std::abs(scan.truth_um[m]))
          << told(c);
    }
  }
}

// Passes straight over a flat-lying relief: registration takes most of a drift up. The check must not say "ok".
TEST(Drift, scan_from_one_side_is_called_blind) {
  Scan scan{.has_sides = false, .truth_um = {0, 0, 0, 0, 5, 5}};
  const DriftCheck c = check(scan, 20);
  EXPECT_THAT(c.blind(), testing::IsSupersetOf({"depth", "twist"})) << told(c);
}

TEST(Drift, too_short_a_scan_is_refused) {
  auto views = scanned({}, 1);
  views.resize(12);
  const auto found = check_drift(std::move(views), kCamera);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kCalibrationPoses);
}

}  // namespace
}  // namespace enamel::calib
