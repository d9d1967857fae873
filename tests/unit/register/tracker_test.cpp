// The tracker on the analytic surface: sweeps with delayed feedback, loss, gaps, refusal, determinism.
#include "pipeline/register/track/tracker.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <vector>

#include "pipeline/register/icp/patch_view.hpp"
#include "tests/unit/register/burst_times.hpp"
#include "tests/unit/register/synthetic_surface.hpp"
#include "tests/unit/register/track_session.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

using ts::hand;
using Session = ts::TrackSession;

TEST(Tracker, follows_a_sweep_with_the_model_two_bursts_behind) {
  Session s(11, 2);
  for (int n = 0; n < 8; ++n) {
    const Pose truth = hand(seconds_of(n));
    const ModelView view = n >= 2 ? s.model_from(hand(seconds_of(n - 2))) : ModelView{};
    const TrackResult r = s.feed(n, truth, view);
    EXPECT_EQ(r.state, n == 0 ? TrackState::kStarted : TrackState::kTracking) << n;
    EXPECT_LT(Session::error_mm(r, truth), 0.003) << n;
  }
}

TEST(Tracker, tracks_from_patch_to_patch_while_there_is_no_model) {
  Session s(12);
  for (int n = 0; n < 5; ++n) {
    const Pose truth = hand(seconds_of(n));
    const TrackResult r = s.feed(n, truth);
    EXPECT_EQ(r.state, n == 0 ? TrackState::kStarted : TrackState::kTracking) << n;
    EXPECT_LT(Session::error_mm(r, truth), 0.01) << n;
  }
}

TEST(Tracker, keeps_up_with_thirty_millimetres_a_second) {
  Session s(20);
  for (int n = 0; n < 8; ++n) {
    const Pose truth = hand(3 * seconds_of(n));  // the tremor too is three times as fast
    const TrackResult r = s.feed(n, truth);
    EXPECT_EQ(r.state, n == 0 ? TrackState::kStarted : TrackState::kTracking) << n;
    EXPECT_LT(Session::error_mm(r, truth), 0.02) << n;
  }
}

TEST(Tracker, stands_the_noise_of_bare_teeth) {
  Session s(21);
  s.sigma_mm = 0.04;
  for (int n = 0; n < 6; ++n) {
    const Pose truth = hand(seconds_of(n));
    const TrackResult r = s.feed(n, truth);
    EXPECT_EQ(r.state, n == 0 ? TrackState::kStarted : TrackState::kTracking) << n;
    EXPECT_LT(Session::error_mm(r, truth), 0.02) << n;
  }
}

TEST(Tracker, bridges_bursts_that_never_came) {
  Session s(13);
  for (const int n : {0, 1, 2, 3, 6, 7, 11, 12}) {
    const Pose truth = hand(seconds_of(n));
    const TrackResult r = s.feed(n, truth);
    EXPECT_NE(r.state, TrackState::kLost) << n;
    EXPECT_LT(Session::error_mm(r, truth), 0.02) << n;
  }
}

/// How many of eight surfaces are still followed when the wrist rolls 40 degrees in the 0.2 s between two bursts.
int followed_over_a_wrist_turn(const TrackerConfig& config) {
  int followed = 0;
  for (std::uint64_t seed = 40; seed < 48; ++seed) {
    Session s(seed, 4, config);
    for (int n = 0; n < 4; ++n) (void)s.feed(n, hand(seconds_of(n)));
    const Pose truth = ts::looking_down(1.5, 0.2, {(seed % 2 == 0 ? 1 : -1) * 0.7, 0.05, 0});
    const TrackResult r = s.feed(9, truth);
    if (r.state != TrackState::kLost && Session::error_mm(r, truth) < 0.05) ++followed;
  }
  return followed;
}

TEST(Tracker, follows_a_wrist_turn_that_sparse_bursts_do_not_foretell) {
  TrackerConfig blind;
  blind.wrist_deg = {0, 0};
  blind.features.ratio = 0;                   // no match: features cannot help out …
  blind.relocalise.votes.max_hypotheses = 0;  // … of neither kind
  TrackerConfig turning = blind;
  turning.wrist_deg = TrackerConfig{}.wrist_deg;
  EXPECT_GE(followed_over_a_wrist_turn(turning), 7);
  EXPECT_LT(followed_over_a_wrist_turn(blind), 4) << "negative control: without turned starts";
}

TEST(Tracker, an_empty_first_patch_does_not_define_the_model) {
  Session s(14);
  const Pose away = ts::looking_down(0, 0, Vec3d::Zero(), 30);  // everything nearer than 40 mm is not measured
  EXPECT_EQ(s.feed(0, ts::SyntheticSurface(14), away).state, TrackState::kLost);
  EXPECT_EQ(s.feed(1, hand(0)).state, TrackState::kStarted);
}

TEST(Tracker, another_surface_is_a_segment_apart_and_the_model_stays_as_it_was) {
  Session s(15);
  for (int n = 0; n < 3; ++n) (void)s.feed(n, hand(seconds_of(n)));
  const std::size_t keyframes = s.tracker().segments().front().keyframes.all().size();
  for (int n = 3; n < 6; ++n) {
    const ts::SyntheticSurface other(300 + static_cast<std::uint64_t>(n));
    const TrackResult r = s.feed(n, other, hand(seconds_of(n)));
    EXPECT_EQ(r.state, TrackState::kStarted) << n;
    EXPECT_EQ(r.segment, static_cast<SegmentId>(n - 2)) << n;
  }
  EXPECT_EQ(s.tracker().segments().front().keyframes.all().size(), keyframes);
  const Pose truth = hand(seconds_of(6));
  const TrackResult r = s.feed(6, truth);
  EXPECT_EQ(r.state, TrackState::kTracking) << "the model is still in reach";
  EXPECT_EQ(r.segment, kModelSegment);
  EXPECT_LT(Session::error_mm(r, truth), 0.02);
}

TEST(Tracker, finds_its_place_after_jumps_on_many_surfaces) {
  int found = 0;
  int wrong = 0;
  constexpr int kTrials = 20;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto key = static_cast<std::uint64_t>(trial);
    Session s(500 + key, 4, ts::believing_one_vote());
    (void)s.feed(0, hand(0));
    const Vec3d turn(0.08 * ts::normal(10 * key), 0.08 * ts::normal(10 * key + 1), 0.6 * ts::normal(10 * key + 2));
    const Pose truth = ts::looking_down(2 * ts::normal(10 * key + 3), 2 * ts::normal(10 * key + 4), turn);
    const TrackResult r = s.feed(40, truth);
    if (r.segment != kModelSegment) continue;
    ++(Session::error_mm(r, truth) < 0.05 ? found : wrong);
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(found, 19);
}

TEST(Keyframes, surface_features_are_the_patchs_own_whenever_they_are_extracted) {
  const calib::Rig rig = ts::test_rig(4);
  const ts::SyntheticSurface surface(33, 1);
  const TrackerConfig config;
  KeyframeStore store(rig.camera, config.keyframes);
  std::vector<std::size_t> expected;
  for (const double x : {0.0, 6.0, 12.0}) {
    const Pose T_model_cam = ts::looking_down(x, 0);
    const SurfacePatch patch = ts::make_patch(surface, rig.camera, T_model_cam, {0.01, 0.03, 1});
    store.add(patch, T_model_cam, view_from_patch(patch, T_model_cam, rig.camera, config.keyframes.view_stride));
    const double px_per_mm = rig.camera.fx / config.keyframes.work_distance_mm;
    expected.push_back(extract_surface_features(patch, px_per_mm, config.keyframes.surface).size());
  }
  ASSERT_GT(expected[0], 20U);
  EXPECT_FALSE(store.all()[0].surface_described);
  store.describe_next_surface();  // the oldest
  store.describe_surface({2});    // the one that is asked for
  EXPECT_TRUE(store.all()[0].surface_described);
  EXPECT_FALSE(store.all()[1].surface_described);
  for (int k = 0; k < 3; ++k) store.describe_next_surface();  // more often than any wait
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(store.all()[k].surface.size(), expected[k]);
    EXPECT_TRUE(store.all()[k].grid.points.empty());
  }
}

/// Two keyframes of a surface that repeats after 24 mm; the patch was taken at the second.
std::optional<Relocalised> search_where_teeth_repeat(std::int64_t repeat) {
  const calib::Rig rig = ts::test_rig(4);
  const ts::SyntheticSurface surface(33, 1, repeat);
  const TrackerConfig config;
  KeyframeStore store(rig.camera, config.keyframes);
  for (const double x : {0.0, 24.0}) {
    const SurfacePatch patch = ts::make_patch(surface, rig.camera, ts::looking_down(x, 0), {0.01, 0.03, 1});
    const Pose T_model_cam = ts::looking_down(x, 0);
    store.add(patch, T_model_cam, view_from_patch(patch, T_model_cam, rig.camera, config.keyframes.view_stride));
  }
  const SurfacePatch patch =
      ts::make_patch(surface, rig.camera, ts::looking_down(24.5, 0.3, {0, 0, 0.2}), {0.01, 0.03, 2});
  const PatchPyramid pyramid = make_pyramid(patch, config.icp);
  return relocalise({patch, pyramid, 7}, {store, Pose::Identity(), 0}, rig.camera, config.icp, config.relocalise);
}

TEST(Relocalise, refuses_to_choose_between_two_places_that_look_alike) {
  EXPECT_FALSE(search_where_teeth_repeat(3));
  const auto unique = search_where_teeth_repeat(0);
  ASSERT_TRUE(unique);
  EXPECT_EQ(unique->keyframe, 1U);
}

TEST(Tracker, refuses_foreign_surfaces_after_jumps) {
  Session s(18, 4, ts::believing_one_vote());
  for (int n = 0; n < 3; ++n) (void)s.feed(n, hand(seconds_of(n)));
  for (int trial = 0; trial < 12; ++trial) {
    const ts::SyntheticSurface other(900 + static_cast<std::uint64_t>(trial));
    EXPECT_EQ(s.feed(100 + 30 * trial, other, hand(0)).state, TrackState::kStarted) << trial;
  }
  EXPECT_EQ(s.tracker().segments().size(), 13U);
}

TEST(Tracker, the_same_sequence_gives_the_same_bits_whatever_the_threads) {
  const int before = cv::getNumThreads();
  std::vector<std::vector<TrackResult>> runs;
  for (const int threads : {1, 4}) {
    cv::setNumThreads(threads);
    Session s(19, 4, ts::believing_one_vote());
    std::vector<TrackResult> results;
    for (const int n : {0, 1, 40, 41})
      results.push_back(s.feed(n, n < 40 ? hand(seconds_of(n)) : ts::looking_down(1, 1, {0, 0, 0.5})));
    runs.push_back(results);
  }
  cv::setNumThreads(before);
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    EXPECT_EQ(runs[0][i].state, runs[1][i].state);
    EXPECT_EQ(runs[0][i].T_model_cam.matrix(), runs[1][i].T_model_cam.matrix());
  }
  EXPECT_EQ(runs[0][2].state, TrackState::kRelocalised);
}

}  // namespace
}  // namespace enamel::pipeline
