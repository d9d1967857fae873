// A hand with tremor: what four exposures average against where the probe was at mid-burst.
#include "pipeline/register/track/mid_burst.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pipeline/register/icp/normal_system.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kPeriod_s = 4e-3, kExposure_s = 3.7e-3, kDepth_mm = 48;

/// Turn and shift of the point kDepth_mm ahead: slow wander and tremor of `tremor_hz`, 50 um and 0.1 degree.
Vector6 path(double t, double tremor_hz) {
  const double w = 2 * std::numbers::pi * tremor_hz;
  Vector6 x;
  x << 0.0017 * std::sin(w * t + 1), 0.0017 * std::cos(0.9 * w * t), 0.1 * t, 9 * t + 0.05 * std::sin(w * t),
      0.05 * std::sin(0.93 * w * t + 2), 0.05 * std::cos(1.1 * w * t);
  return x;
}

Pose pose_at(double t, double tremor_hz) {
  return apply_motion(path(t, tremor_hz), {0, 0, kDepth_mm}, 1.0, Pose::Identity());
}

ProbeTwist twist_at(double t, double tremor_hz) {
  const double h = 1e-5;
  const Pose T = pose_at(t, tremor_hz);
  const Vec3d work = T * Vec3d(0, 0, kDepth_mm);
  const Vector6 x = motion_between(pose_at(t - h, tremor_hz), pose_at(t + h, tremor_hz), work, 1.0) / (2 * h);
  return {T.linear().transpose() * x.tail<3>(), T.linear().transpose() * x.head<3>(), kDepth_mm};
}

/// As registration sees it: the mean over the four exposures, in 64 instants each.
MeasuredPose measured(double t, double tremor_hz, bool with_twist) {
  constexpr int kInstants = 64;
  const Pose middle = pose_at(t, tremor_hz);
  const Vec3d work = middle * Vec3d(0, 0, kDepth_mm);
  Vector6 mean = Vector6::Zero();
  double spread = 0;
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < kInstants; ++i) {
      const double s = (k - 1.5) * kPeriod_s + ((i + 0.5) / kInstants - 0.5) * kExposure_s;
      mean += motion_between(middle, pose_at(t + s, tremor_hz), work, 1.0) / (4 * kInstants);
      spread += s * s / (4 * kInstants);
    }
  }
  MeasuredPose out{device_time(std::llround(t * 1e9)), apply_motion(mean, work, 1.0, middle), {}};
  out.motion.exposure_spread_s2 = spread;
  if (with_twist) out.motion.twist = twist_at(t, tremor_hz);
  return out;
}

double error_um(const Pose& a, const Pose& b) {
  return 1e3 * (a * Vec3d(0, 0, kDepth_mm) - b * Vec3d(0, 0, kDepth_mm)).norm();
}

struct Errors {
  double before = 0, after = 0;  ///< largest of the inner bursts, um
};

Errors errors(double rate_hz, double tremor_hz, bool with_twist) {
  std::vector<MeasuredPose> poses;
  for (int n = 0; n < 30; ++n) poses.push_back(measured(n / rate_hz, tremor_hz, with_twist));
  const std::vector<Pose> found = poses_at_mid_burst(poses, {});
  Errors out;
  for (std::size_t n = 1; n + 1 < poses.size(); ++n) {
    const Pose truth = pose_at(static_cast<double>(n) / rate_hz, tremor_hz);
    out.before = std::max(out.before, error_um(poses[n].T_model_cam, truth));
    out.after = std::max(out.after, error_um(found[n], truth));
  }
  return out;
}

TEST(MidBurst, tremor_leaves_microns_and_the_trajectory_takes_them_back) {
  for (const double tremor_hz : {8.0, 10.0, 12.0}) {
    const Errors with = errors(30, tremor_hz, true), without = errors(30, tremor_hz, false);
    EXPECT_GT(with.before, 1.5) << tremor_hz;
    EXPECT_LT(with.after, 0.2 * with.before) << tremor_hz;  // at 12 Hz five conditions span 288 degrees of a period
    EXPECT_LT(without.after, 0.6 * without.before) << tremor_hz;  // positions alone are too sparse for it
    EXPECT_LT(with.after, without.after) << tremor_hz;
  }
}

TEST(MidBurst, without_both_neighbours_nothing_is_guessed) {
  std::vector<MeasuredPose> poses;
  for (const double t : {0.0, 0.033, 0.066, 0.2, 0.233}) poses.push_back(measured(t, 10, true));
  const std::vector<Pose> found = poses_at_mid_burst(poses, {});
  for (const std::size_t n : {0U, 2U, 3U, 4U}) EXPECT_EQ(found[n].matrix(), poses[n].T_model_cam.matrix()) << n;
  EXPECT_NE(found[1].matrix(), poses[1].T_model_cam.matrix());
  EXPECT_TRUE(poses_at_mid_burst({}, {}).empty());
}

TEST(MidBurst, steady_motion_stays) {
  std::vector<MeasuredPose> poses;
  for (int n = 0; n < 5; ++n) {
    MeasuredPose p{device_time(n * 33'000'000), pose_at(0.033 * n, 0), {}};
    p.motion = {twist_at(0.033 * n, 0), 2e-5};
    poses.push_back(p);
  }
  const std::vector<Pose> found = poses_at_mid_burst(poses, {});
  for (std::size_t n = 0; n < poses.size(); ++n) EXPECT_LT(error_um(found[n], poses[n].T_model_cam), 0.01) << n;
}

TEST(MidBurst, bursts_at_one_instant_do_not_divide_by_zero) {
  std::vector<MeasuredPose> poses(3, measured(0.1, 10, true));
  const std::vector<Pose> found = poses_at_mid_burst(poses, {});
  for (const Pose& T : found) EXPECT_TRUE(T.matrix().allFinite());
}

}  // namespace
}  // namespace enamel::pipeline
