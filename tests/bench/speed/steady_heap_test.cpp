// Registration and fusion ask for no memory once they have seen as much as they are shown.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "pipeline/model/fuse/tsdf_model.hpp"
#include "pipeline/register/track/tracker.hpp"
#include "tests/bench/speed/malloc_count.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::bench {
namespace {

using Patches = std::vector<std::shared_ptr<const SurfacePatch>>;

/// A probe over three balls, which hold each other in all six directions, and how it moves.
struct Scene {
  explicit Scene(std::uint64_t seed) {
    synthetic::Random draw(seed);
    const auto ball = [&](double x, double y) {
      return synthetic::sphere(Vec3d(x, y, 0) + 0.5 * draw.vector(), 3 + draw.uniform());
    };
    const auto surface = synthetic::nearest(synthetic::nearest(ball(-3, -2), ball(3, -1)), ball(0, 3));
    Vec3d target = Vec3d::Zero();
    for (int n = 0; n < 4; ++n) {
      target += 0.2 * draw.vector();
      poses.push_back(synthetic::looking_at(target, Vec3d(0, 0, 1), 48));
      const synthetic::RenderOptions noisy{.sigma_mm = 0.0085, .noisy = true, .seed = seed + static_cast<unsigned>(n)};
      patches.push_back(std::make_shared<const SurfacePatch>(synthetic::render(rig, surface, poses.back(), noisy)));
    }
  }
  calib::Rig rig = synthetic::small_rig();
  std::vector<Pose> poses;
  Patches patches;
};

class SteadyHeap : public testing::TestWithParam<std::uint64_t> {};

TEST_P(SteadyHeap, a_model_that_has_its_blocks_asks_for_no_more) {
  const Scene scene(GetParam());
  pipeline::TsdfModel model(scene.rig);
  std::uint64_t burst = 0, first_round = 0;
  for (int round = 0; round < 4; ++round) {
    const std::uint64_t before = heap_use().blocks;
    for (std::size_t n = 0; n < scene.patches.size(); ++n)
      ASSERT_GT(model.integrate(BurstId{burst++}, *scene.patches[n], scene.poses[n]).voxels_updated, 0U);
    const std::uint64_t asked = heap_use().blocks - before;
    if (round == 0) first_round = asked;
    if (round == 3) {
      EXPECT_EQ(asked, 0U);
    }
  }
  EXPECT_GT(first_round, 10U);  // the control: the count sees a model grow
}

TEST_P(SteadyHeap, a_hand_that_stays_where_it_was_is_followed_without_a_block) {
  const Scene scene(GetParam());
  pipeline::TsdfModel model(scene.rig);
  for (std::size_t n = 0; n < scene.patches.size(); ++n)
    (void)model.integrate(BurstId{n}, *scene.patches[n], scene.poses[0].inverse() * scene.poses[n]);
  ModelView view = model.view(Pose::Identity(), *scene.patches[0]);
  view.drawing = 1;
  pipeline::Tracker tracker(scene.rig, {});
  std::uint64_t first_round = 0;
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    const std::uint64_t before = heap_use().blocks;
    for (std::size_t n = 0; n < scene.patches.size(); ++n) {
      const std::size_t burst = static_cast<std::size_t>(round) * scene.patches.size() + n;
      const DeviceTime t{std::chrono::milliseconds(40 * burst)};
      const TrackResult placed = tracker.track(BurstId{burst}, t, scene.patches[n], view);
      ASSERT_EQ(placed.segment, kModelSegment);
      if (round + 1 == kRounds) {
        EXPECT_EQ(placed.state, TrackState::kTracking);
      }
    }
    const std::uint64_t asked = heap_use().blocks - before;
    if (round == 0) first_round = asked;
    if (round + 1 == kRounds) {
      EXPECT_EQ(asked, 0U);
    }
  }
  EXPECT_GT(first_round, 10U);  // the control: the first burst makes a keyframe
}

INSTANTIATE_TEST_SUITE_P(Draws, SteadyHeap, testing::Values(1U, 2U, 3U));

}  // namespace
}  // namespace enamel::bench
