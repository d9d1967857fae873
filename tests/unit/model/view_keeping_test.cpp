#include "pipeline/model/fuse/view_keeping.hpp"

#include <gtest/gtest.h>

namespace enamel::pipeline {
namespace {

TEST(ViewKeeping, a_view_serves_until_the_camera_moved_on_or_three_bursts_had_it) {
  const FuseConfig config;
  const Vec3d looked_at(0, 0, 48);
  ModelView view;
  view.empty = false;
  const auto shows = [&](const Pose& T, int served = 1, SegmentId segment = kModelSegment) {
    return still_shows(view, served, segment, T, looked_at, config);
  };
  const auto shifted = [](double mm) { return Pose(Eigen::Translation3d(mm, 0, 0)); };
  const auto turned = [](double deg) { return Pose(Eigen::AngleAxisd(deg * 0.0174533, Vec3d::UnitZ())); };
  EXPECT_TRUE(shows(shifted(0.9)) && shows(turned(2.9)));
  EXPECT_FALSE(shows(shifted(1.1)));
  EXPECT_FALSE(shows(turned(3.1)));
  EXPECT_FALSE(shows(Pose(Eigen::AngleAxisd(0.03, Vec3d::UnitX()))));  // under 2 degrees, but 1.4 mm at the surface
  EXPECT_TRUE(shows(Pose::Identity(), config.view_kept_bursts - 1));
  EXPECT_FALSE(shows(Pose::Identity(), config.view_kept_bursts));
  EXPECT_FALSE(shows(Pose::Identity(), 1, SegmentId{1}));
  view.empty = true;
  EXPECT_FALSE(shows(Pose::Identity()));
}

}  // namespace
}  // namespace enamel::pipeline
