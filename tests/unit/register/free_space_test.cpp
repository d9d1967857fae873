// What other bursts looked through is taken out of a burst before it is fused for good; what only it saw stays.
#include "pipeline/register/map/free_space.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pipeline/register/icp/patch_view.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

class FreeSpaceTest : public ::testing::Test {
 protected:
  FreeSpaceTest() {
    for (int k = 0; k < 6; ++k) {
      const Pose T = ts::looking_down(2.1 * k - 4, 0);
      add(T, patch_at(T), k * std::int64_t{2'000'000'000});
    }
  }
  [[nodiscard]] SurfacePatch patch_at(const Pose& T) const {
    return ts::make_patch(surface_, rig_.camera, T, {0.01, 0.03, 5});
  }
  void add(const Pose& T, const SurfacePatch& patch, std::int64_t t_ns = 0) {
    nodes_.push_back(MapNode{{}, Reference(view_from_patch(patch, Pose::Identity(), rig_.camera, 1), {}), {}, {}});
    seen_from_.push_back({device_time(t_ns), T});
  }
  [[nodiscard]] FreeSpace made() const {
    const auto node = [nodes = nodes_](std::size_t k) { return nodes[k]; };
    return {std::make_shared<const MapNodes>(nodes_.size(), 3, node), seen_from_, ViewCamera(rig_.camera), 48, {}};
  }
  /// Lifts what is right of column `from` towards the camera, as one order too few does; a gap lies between.
  static std::size_t lift(SurfacePatch& patch, int from, float by_mm) {
    std::size_t lifted = 0;
    for (int v = 0; v < patch.points.height(); ++v) {
      for (int u = from - 2; u < patch.points.width(); ++u) {
        if (!std::isfinite(patch.points(u, v).x())) continue;
        const float z = patch.depth_mm(u, v) - by_mm;
        patch.points(u, v) *= z / patch.depth_mm(u, v);
        patch.depth_mm(u, v) = z;
        if (u >= from) {
          ++lifted;
          continue;
        }
        patch.depth_mm(u, v) = std::nanf("");
        patch.points(u, v) = Vec3f::Constant(std::nanf(""));
      }
    }
    return lifted;
  }
  calib::Rig rig_ = ts::test_rig(4);
  ts::SyntheticSurface surface_{71};
  std::vector<MapNode> nodes_;
  std::vector<MapBurst> seen_from_;
};

TEST_F(FreeSpaceTest, a_region_one_order_too_near_goes_and_the_rest_stays) {
  const Pose T = ts::looking_down(1.2, 0.2, {0.05, 0, 0});
  SurfacePatch patch = patch_at(T);
  const std::size_t lifted = lift(patch, 100, 3.4F);
  ASSERT_GT(lifted, 1000U);
  const std::size_t gone = made().withdraw({{}, T}, patch);
  EXPECT_NEAR(static_cast<double>(gone), static_cast<double>(lifted), 0.1 * static_cast<double>(lifted));
  std::size_t left = 0;
  for (int v = 0; v < patch.depth_mm.height(); ++v) left += std::isfinite(patch.depth_mm(50, v)) ? 1U : 0U;
  EXPECT_GT(left, static_cast<std::size_t>(0.9 * patch.depth_mm.height())) << "the other half is as it was";
}

TEST_F(FreeSpaceTest, a_true_patch_keeps_every_pixel_from_any_side) {
  for (const double tilt : {0.0, 0.3, -0.3}) {
    const Pose T = ts::looking_down(1.2, 0.2, {0, tilt, 0});
    SurfacePatch patch = patch_at(T);
    EXPECT_LT(made().withdraw({{}, T}, patch), patch.points.size() / 500) << tilt;
  }
}

TEST_F(FreeSpaceTest, one_that_looked_through_is_not_enough_and_nobody_is_asked_far_away) {
  nodes_.resize(1);
  seen_from_.resize(1);
  const Pose T = ts::looking_down(0.2, 0.1);
  SurfacePatch patch = patch_at(T);
  (void)lift(patch, 100, 3.4F);
  EXPECT_EQ(made().withdraw({{}, T}, patch), 0U);
  SurfacePatch elsewhere = patch_at(ts::looking_down(40, 0));
  EXPECT_EQ(made().withdraw({{}, ts::looking_down(40, 0)}, elsewhere), 0U);
}

/// A body that stands 2 mm before the surface, or not, when keyframes look.
class PassingBodyTest : public FreeSpaceTest {
 protected:
  PassingBodyTest() {
    nodes_.clear();
    seen_from_.clear();
  }
  void see(std::int64_t t_ns, bool body, int times) {
    for (int k = 0; k < times; ++k) {
      const Pose T = ts::looking_down(2.1 * k - 3, 0);
      SurfacePatch patch = patch_at(T);
      if (body) (void)lift(patch, 40, 2.0F);
      add(T, patch, t_ns);
    }
  }
  [[nodiscard]] double share_gone() const {
    const Pose T = ts::looking_down(0, 0);
    SurfacePatch patch = patch_at(T);
    const std::size_t lifted = lift(patch, 100, 2.0F);
    return static_cast<double>(made().withdraw({device_time(0), T}, patch)) / static_cast<double>(lifted);
  }
  static constexpr std::int64_t kLaterNs = 5'000'000'000;
};

TEST_F(PassingBodyTest, at_rest_for_a_moment_goes_though_many_saw_it) {
  see(0, true, 4);
  see(kLaterNs, false, 3);
  EXPECT_GT(share_gone(), 0.85);
}

TEST_F(PassingBodyTest, seen_again_as_often_as_looked_through_stays) {
  see(0, true, 4);
  see(kLaterNs, true, 4);
  see(2 * kLaterNs, false, 3);
  EXPECT_LT(share_gone(), 0.05);
}

TEST_F(PassingBodyTest, that_nobody_looked_through_stays) {
  see(0, true, 4);
  EXPECT_LT(share_gone(), 0.01);
}

}  // namespace
}  // namespace enamel::pipeline
