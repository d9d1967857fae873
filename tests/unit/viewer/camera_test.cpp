// View camera, follow camera, overview, field of view, path, pacing.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/viewer/tooth_scene.hpp"
#include "viewer/scene/follow_camera.hpp"
#include "viewer/scene/frame_pacer.hpp"
#include "viewer/scene/trail.hpp"

namespace enamel::view::test {
namespace {

Eigen::Vector3d on_screen(const ViewCamera& camera, const Vec3d& point, double aspect = 1.6) {
  const Eigen::Vector4f clip =
      projection_matrix(camera, aspect) * view_matrix(camera) * point.cast<float>().homogeneous();
  return (clip.head<3>() / clip.w()).cast<double>();
}

TEST(ViewCamera, target_is_in_the_middle_of_the_screen) {
  ViewCamera camera;
  camera.target = {3, -5, 40};
  orbit(camera, 0.7, -0.3);
  EXPECT_NEAR(on_screen(camera, camera.target).head<2>().norm(), 0, 1e-5);
  EXPECT_NEAR((eye(camera) - camera.target).norm(), camera.distance_mm, 1e-9);
}

TEST(ViewCamera, orbit_turns_the_model_with_the_pointer) {
  ViewCamera camera;
  const Vec3d towards_viewer(0, 0, 5);
  orbit(camera, 0.2, 0);
  EXPECT_GT(on_screen(camera, towards_viewer).x(), 0.01);
  ViewCamera other;
  orbit(other, 0, 0.2);  // y is up on the screen: dragging down lowers what is near
  EXPECT_LT(on_screen(other, towards_viewer).y(), -0.01);
}

TEST(ViewCamera, pan_moves_the_model_by_the_same_share_of_the_picture) {
  ViewCamera camera;
  orbit(camera, 0.4, 0.9);
  const Vec3d point = camera.target;
  pan(camera, 0.25, 0.1);
  const Eigen::Vector3d now = on_screen(camera, point, 1.0);
  EXPECT_NEAR(now.x(), 0.5, 1e-5);  // a quarter of the height = half of the way from middle to edge
  EXPECT_NEAR(now.y(), -0.2, 1e-5);
}

TEST(ViewCamera, zoom_stays_within_its_limits) {
  ViewCamera camera;
  for (int i = 0; i < 100; ++i) {
    zoom(camera, 1.5);
  }
  EXPECT_DOUBLE_EQ(camera.distance_mm, kMinDistanceMm);
  zoom(camera, 1e-9);
  EXPECT_DOUBLE_EQ(camera.distance_mm, kMaxDistanceMm);
  zoom(camera, std::nan(""));
  zoom(camera, -1);
  EXPECT_DOUBLE_EQ(camera.distance_mm, kMaxDistanceMm);
}

TEST(FollowCamera, goal_looks_at_the_surface_from_the_probes_side) {
  const FollowConfig config;
  const ViewCamera goal = follow_goal(Pose::Identity(), 48, ProbeField{}, config);
  const Eigen::Vector3d spot = on_screen(goal, Vec3d(0, 0, 48));
  EXPECT_NEAR(spot.y(), 0, 1e-4);
  EXPECT_GT(spot.x(), 0);  // right of the middle, clear of the live image
  EXPECT_LT(spot.x(), 0.3);
  EXPECT_LT(eye(goal).z(), 30);                               // on the probe's side of the teeth
  EXPECT_LT(on_screen(goal, Vec3d(0, 0, 40)).z(), spot.z());  // nearer to the probe = nearer to the viewer
}

TEST(FollowCamera, rests_under_tremor_and_moves_for_a_travel) {
  FollowCamera follow;
  const FollowConfig config;
  Pose pose = Pose::Identity();
  ViewCamera camera = follow.step({}, follow_goal(pose, 48, {}, config), 0);
  const ViewCamera rest = camera;
  for (int i = 0; i < 50; ++i) {
    pose.translation().x() = 0.8 * std::sin(i);
    camera = follow.step(camera, follow_goal(pose, 48, {}, config), 0.05);
  }
  EXPECT_EQ(camera.target, rest.target);
  EXPECT_FALSE(follow.moving());
  pose.translation().x() = 10;
  const ViewCamera goal = follow_goal(pose, 48, {}, config);
  double before = (camera.target - goal.target).norm();
  for (int i = 0; i < 100; ++i) {
    camera = follow.step(camera, goal, 0.05);
    const double now = (camera.target - goal.target).norm();
    EXPECT_LE(now, before + 1e-12);
    before = now;
  }
  EXPECT_LE(before, config.stop_mm);
  EXPECT_FALSE(follow.moving());
}

TEST(FollowCamera, never_turns_faster_than_thirty_degrees_a_second) {
  FollowCamera follow;
  const FollowConfig config;
  Pose pose = Pose::Identity();
  ViewCamera camera = follow.step({}, follow_goal(pose, 48, {}, config), 0);
  pose.linear() = Eigen::AngleAxisd(2.5, Vec3d(1, 2, 0.5).normalized()).toRotationMatrix();
  const ViewCamera goal = follow_goal(pose, 48, {}, config);
  for (int i = 0; i < 400; ++i) {
    const ViewCamera next = follow.step(camera, goal, 0.02);
    EXPECT_LE(next.R_model_view.angularDistance(camera.R_model_view), std::numbers::pi / 6 * 0.02 + 1e-9);
    camera = next;
  }
  EXPECT_LE(camera.R_model_view.angularDistance(goal.R_model_view), config.stop_rad);
}

TEST(FollowCamera, motion_does_not_depend_on_the_frame_rate) {
  const FollowConfig config;
  Pose pose = Pose::Identity();
  pose.translation().x() = 20;
  const ViewCamera start = follow_goal(Pose::Identity(), 48, {}, config);
  const ViewCamera goal = follow_goal(pose, 48, {}, config);
  const auto after_half_a_second = [&](int steps) {
    FollowCamera follow;
    ViewCamera camera = follow.step(start, start, 0);
    for (int i = 0; i < steps; ++i) {
      camera = follow.step(camera, goal, 0.5 / steps);
    }
    return camera.target;
  };
  EXPECT_NEAR((after_half_a_second(5) - after_half_a_second(50)).norm(), 0, 1e-9);
}

TEST(Overview, holds_every_vertex_inside_the_picture) {
  const auto model = ToothScene{}.model(1.0, 10, nullptr);
  for (const double aspect : {1.0, 1.6, 2.4}) {
    const auto camera = overview(*model, aspect);
    ASSERT_TRUE(camera);
    double widest = 0;
    for (const auto& block : model->blocks) {
      for (const Vec3f& v : block->vertices) {
        const Eigen::Vector3d p = on_screen(*camera, v.cast<double>(), aspect);
        ASSERT_LT(std::abs(p.x()), 1.0);
        ASSERT_LT(std::abs(p.y()), 1.0);
        widest = std::max({widest, std::abs(p.x()), std::abs(p.y())});
      }
    }
    EXPECT_GT(widest, 0.6);                           // and fills it
    EXPECT_LT(eye(*camera).z(), camera->target.z());  // from the side that was scanned
  }
}

TEST(Overview, empty_model_has_none) { EXPECT_FALSE(overview(ModelSnapshot{}, 1.6)); }

TEST(ProbeField, corners_of_a_pinhole_and_optimum_inside_the_range) {
  const ProbeField field = probe_field({640, 480, 1500, 1500, 319.5, 239.5}, 40, 56);
  EXPECT_NEAR(field.corner_rays[2].x(), 320.0 / 1500, 1e-6);
  EXPECT_NEAR(field.corner_rays[0].y(), -240.0 / 1500, 1e-6);
  EXPECT_DOUBLE_EQ(field.optimum_near_mm, 45);
  EXPECT_DOUBLE_EQ(field.optimum_far_mm, 51);
  EXPECT_EQ(probe_field({0, 480, 1500, 1500, 0, 0}, 40, 56).far_mm, ProbeField{}.far_mm);
  EXPECT_EQ(probe_field({640, 480, 1500, 1500, 0, 0}, 56, 40).near_mm, ProbeField{}.near_mm);
}

TEST(ProbeField, frustum_follows_the_pose) {
  Pose pose = Pose::Identity();
  pose.translation() = Vec3d(1, 2, 3);
  const FrustumGeometry shape = frustum(ProbeField{}, pose);
  EXPECT_TRUE(shape.points[0].isApprox(Vec3f(1, 2, 3)));
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_FLOAT_EQ(shape.points[i].z(), 43.0F);
    EXPECT_FLOAT_EQ(shape.points[i + 4].z(), 59.0F);
  }
}

/// Of a probe that is tracked at its working distance.
PreviewFrame tracked_frame() {
  PreviewFrame frame;
  frame.placed = true;
  frame.track = TrackState::kTracking;
  frame.surface_distance_mm = 48;
  return frame;
}

TEST(Trail, breaks_where_tracking_was_lost_and_ignores_standing_still) {
  Trail trail(ProbeField{});
  PreviewFrame frame = tracked_frame();
  const auto at = [&](std::uint64_t burst, double x, TrackState state) {
    frame.burst = BurstId{burst};
    frame.T_model_cam.translation().x() = x;
    frame.track = state;
    trail.add(frame);
  };
  at(0, 0, TrackState::kStarted);
  at(0, 5, TrackState::kTracking);  // same burst again
  at(1, 0.05, TrackState::kTracking);
  at(2, 1, TrackState::kTracking);
  at(3, 1, TrackState::kLost);
  at(4, 1, TrackState::kLost);
  at(5, 9, TrackState::kRelocalised);
  const auto points = trail.points().in_order();
  ASSERT_EQ(points.size(), 4U);
  EXPECT_FALSE(points[2].allFinite());
  EXPECT_FLOAT_EQ(points[3].x(), 9.0F);
  EXPECT_FLOAT_EQ(points[0].z(), 44.0F);
}

TEST(Trail, shows_nothing_of_a_segment_in_another_frame) {
  Trail trail(ProbeField{});
  PreviewFrame frame = tracked_frame();
  for (std::uint64_t n = 0; n < 9; ++n) {
    frame.burst = BurstId{n};
    frame.segment = n >= 3 && n < 6 ? 1U : kModelSegment;
    frame.T_model_cam.translation().x() = frame.segment == 1U ? 500 : static_cast<double>(n);
    trail.add(frame);
  }
  std::size_t breaks = 0;
  for (const Vec3f& point : trail.points().in_order()) {
    breaks += point.allFinite() ? 0U : 1U;
    EXPECT_FALSE(point.x() > 100);
  }
  EXPECT_EQ(breaks, 1U);
}

TEST(Trail, stays_bounded) {
  Trail trail(ProbeField{}, 0.1, 100);
  PreviewFrame frame;
  frame.placed = true;
  frame.track = TrackState::kTracking;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    frame.burst = BurstId{i};
    frame.T_model_cam.translation().x() = static_cast<double>(i);
    trail.add(frame);
  }
  EXPECT_LE(trail.points().size(), 101U);
  EXPECT_FLOAT_EQ(trail.points().in_order().back().x(), 4999.0F);
}

TEST(Trail, a_path_that_was_shared_stays_as_it_was) {
  Trail trail(ProbeField{}, 0.1, 100);
  BurstPreview burst;
  burst.placed = true;
  burst.track = TrackState::kTracking;
  const auto add = [&](std::uint64_t i) {
    burst.burst = BurstId{i};
    burst.T_model_cam.translation().x() = static_cast<double>(i);
    trail.add(burst);
  };
  for (std::uint64_t i = 0; i < 50; ++i) add(i);
  const auto early = trail.points();
  const auto before = early.in_order();
  for (std::uint64_t i = 50; i < 500; ++i) add(i);  // is thinned out meanwhile
  ASSERT_EQ(before.size(), 50U);
  EXPECT_EQ(early.in_order(), before);
  EXPECT_NE(trail.points().in_order().front(), trail.points().in_order().back());
}

TEST(FramePacer, keeps_the_rate_and_the_busy_share) {
  FramePacer pacer(20, {.usual = 0.4, .yielding = 0.1});
  const HostTime t0 = host_time(1'000'000'000);
  pacer.drawn(t0, t0 + Nanoseconds{5'000'000});
  EXPECT_EQ(pacer.due(), t0 + Nanoseconds{50'000'000});
  pacer.drawn(t0, t0 + Nanoseconds{60'000'000});
  EXPECT_EQ(pacer.due(), t0 + Nanoseconds{150'000'000});
}

TEST(FramePacer, yields_to_the_pipeline_while_bursts_are_shed) {
  FramePacer pacer(20, {.usual = 0.4, .yielding = 0.1});
  const auto due_after = [&](std::uint64_t shed, int at_s) {
    const HostTime began = host_time(1'000'000'000LL * at_s);
    pacer.told(shed, began);
    pacer.drawn(began, began + Nanoseconds{40'000'000});
    return (pacer.due() - began) / Nanoseconds{1'000'000};
  };
  EXPECT_EQ(due_after(0, 1), 100);
  EXPECT_EQ(due_after(3, 2), 400);
  EXPECT_EQ(due_after(3, 3), 400) << "a queue is long for a while";
  EXPECT_EQ(due_after(3, 5), 100);
  EXPECT_EQ(due_after(4, 6), 400);
  EXPECT_EQ(due_after(0, 9), 100) << "another scan begins its count anew";
}

}  // namespace
}  // namespace enamel::view::test
