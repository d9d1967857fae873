// The tracker on the analytic surface: sweeps, feedback delay, loss, gaps, refusal.
#include "pipeline/algo/track/tracker.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/registration/synthetic_surface.hpp"

namespace enamel::algo {
namespace {

namespace ts = ::enamel::testing;

constexpr std::int64_t kPeriodNs = 33'333'333;

struct World {
  calib::Rig rig = ts::test_rig();
  ts::SyntheticSurface surface{11};
  double sigma_mm = 0.01;

  [[nodiscard]] SurfacePatch patch(const Pose& truth, std::uint64_t n) const {
    return ts::make_patch(surface, rig.camera, truth, {sigma_mm, 0.03, n + 100});
  }
};

/// A hand moving 10 mm/s along x with 60 µm of 9 Hz tremor and a slow turn.
Pose hand(double t_s) {
  const double wave = std::sin(2 * std::numbers::pi * 9 * t_s);
  return ts::looking_down(10 * t_s, 0.06 * wave, {0.05 * t_s, 0.1 * t_s + 0.001 * wave, 0.03 * t_s}, 0.05 * wave);
}

DeviceTime time_of(int n) { return device_time(1'000'000'000 + n * kPeriodNs); }

TEST(Tracker, FollowsASweepWithTheModelTwoBurstsBehind) {
  const World world;
  Tracker tracker(world.rig, {});
  const Pose first = hand(0);
  for (int n = 0; n < 12; ++n) {
    const Pose truth = hand(n * 1e-9 * kPeriodNs);
    // The model after burst n-2: the exact surface, in the tracker's frame (that of burst 0), drawn from its pose
    // there.
    ModelView view;
    if (n >= 2) view = ts::view_in_frame(world.surface, world.rig.camera, hand((n - 2) * 1e-9 * kPeriodNs), first);
    const TrackResult r = tracker.track(BurstId{static_cast<std::uint64_t>(n)}, time_of(n),
                                        world.patch(truth, static_cast<std::uint64_t>(n)), view);
    EXPECT_EQ(r.state, n == 0 ? TrackState::kStarted : TrackState::kTracking) << n;
    EXPECT_LT(ts::point_error_mm(first * r.T_model_cam, truth), 0.005) << n;
  }
}

TEST(Tracker, FindsItsPlaceAgainAfterAJump) {
  const World world;
  Tracker tracker(world.rig, {});
  const Pose first = hand(0);
  (void)tracker.track(BurstId{0}, time_of(0), world.patch(first, 0), {});
  int found = 0;
  for (int n = 1; n < 21; ++n) {
    const auto key = static_cast<std::uint64_t>(n) * 10;
    const Pose truth =
        ts::looking_down(3 * ts::normal(key), 3 * ts::normal(key + 1),
                         {0.1 * ts::normal(key + 2), 0.1 * ts::normal(key + 3), 0.5 * ts::normal(key + 4)});
    const TrackResult r = tracker.track(BurstId{static_cast<std::uint64_t>(n)}, time_of(100 * n),
                                        world.patch(truth, static_cast<std::uint64_t>(n)), {});
    found += r.state == TrackState::kRelocalised;
    if (r.state == TrackState::kLost) continue;
    EXPECT_LT(ts::point_error_mm(first * r.T_model_cam, truth), 0.05) << n;
  }
  EXPECT_GE(found, 19);
}

}  // namespace
}  // namespace enamel::algo
