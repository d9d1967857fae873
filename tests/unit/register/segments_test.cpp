// Segments of a scan: what cannot be placed begins one, what is found again is joined, nothing is joined on one word.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "pipeline/register/track/join_votes.hpp"
#include "pipeline/register/track/tracker.hpp"
#include "tests/unit/register/burst_times.hpp"
#include "tests/unit/register/synthetic_surface.hpp"
#include "tests/unit/register/track_session.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;
using ts::hand;
using Session = ts::TrackSession;

/// Elsewhere on the model after a pause, going on from there.
Pose back_again(int n) { return ts::looking_down(-2 + 0.2 * n, 1.5, {0.05, -0.08, 0.4}); }

/// As far beside what is known that nothing of it is in view.
Pose far_off(int n) { return ts::looking_down(60 + 0.3 * n, 60); }

JoinVote vote(std::uint64_t burst, const Pose& T, SegmentId segment = 1, SegmentId into = 0) {
  return {BurstId{burst}, {segment, into, T}, Vec3d(0, 0, 48)};
}

Pose shifted(double x_mm) { return Pose(Eigen::Translation3d(x_mm, 0, 0)); }

TEST(JoinVotes, three_that_agree_join_at_their_mean) {
  JoinVotes votes({});
  EXPECT_FALSE(votes.add(vote(1, shifted(5.00))));
  EXPECT_FALSE(votes.add(vote(2, shifted(5.03))));
  const auto join = votes.add(vote(3, shifted(5.06)));
  ASSERT_TRUE(join);
  EXPECT_NEAR(join->T_into_segment.translation().x(), 5.03, 1e-9);
  EXPECT_EQ(join->segment, 1U);
  EXPECT_EQ(join->into, 0U);
}

TEST(JoinVotes, three_that_differ_do_not) {
  JoinVotes votes({});
  for (std::uint64_t n = 0; n < 9; ++n) EXPECT_FALSE(votes.add(vote(n, shifted(0.2 * static_cast<double>(n))))) << n;
}

TEST(JoinVotes, one_burst_has_one_vote_and_pairs_are_kept_apart) {
  JoinVotes votes({});
  for (int n = 0; n < 4; ++n) EXPECT_FALSE(votes.add(vote(7, shifted(5))));
  EXPECT_FALSE(votes.add(vote(8, shifted(5), 2)));
  EXPECT_FALSE(votes.add(vote(9, shifted(5))));
  EXPECT_TRUE(votes.add(vote(10, shifted(5))));
}

TEST(JoinVotes, a_segment_that_is_no_more_is_forgotten) {
  JoinVotes votes({});
  EXPECT_FALSE(votes.add(vote(1, shifted(5))));
  EXPECT_FALSE(votes.add(vote(2, shifted(5))));
  votes.forget(1);
  EXPECT_FALSE(votes.add(vote(3, shifted(5))));
}

TEST(JoinVotes, a_search_asks_the_model_and_a_few_others_and_reaches_all_by_turns) {
  std::vector<SegmentId> older;
  for (SegmentId id = 0; id < 50; ++id) older.push_back(id);
  std::vector<int> asked(50);
  for (std::uint64_t turn = 0; turn < 50; ++turn) {
    const auto now = segments_to_ask(older, turn, 4);
    ASSERT_EQ(now.size(), 4U);
    EXPECT_EQ(now.front(), kModelSegment);
    for (const SegmentId id : now) ++asked[id];
  }
  for (const int times : asked) EXPECT_GE(times, 3);
  EXPECT_EQ(segments_to_ask({0, 1, 2}, 7, 4), (std::vector<SegmentId>{0, 1, 2}));
  EXPECT_TRUE(segments_to_ask({}, 7, 4).empty());
}

TEST(Segments, a_place_found_again_waits_for_three_bursts_and_is_joined) {
  Session s(16);
  for (int n = 0; n < 4; ++n) (void)s.feed(n, hand(seconds_of(n)));
  std::vector<TrackResult> waiting;
  for (int n = 60; n < 62; ++n) waiting.push_back(s.feed(n, back_again(n - 60)));
  EXPECT_EQ(waiting[0].state, TrackState::kStarted);
  EXPECT_EQ(waiting[1].state, TrackState::kTracking);
  const TrackResult joined = s.feed(62, back_again(2));
  EXPECT_EQ(joined.state, TrackState::kRelocalised);
  EXPECT_EQ(joined.segment, kModelSegment);
  EXPECT_LT(Session::error_mm(joined, back_again(2)), 0.03);
  ASSERT_EQ(joined.joins.size(), 1U);
  for (int n = 0; n < 2; ++n) {
    TrackResult moved = waiting[static_cast<std::size_t>(n)];
    EXPECT_EQ(moved.segment, 1U);
    moved.T_model_cam = joined.joins[0].T_into_segment * moved.T_model_cam;
    EXPECT_LT(Session::error_mm(moved, back_again(n)), 0.03) << n;
  }
  const TrackResult after = s.feed(63, back_again(3));
  EXPECT_EQ(after.state, TrackState::kTracking);
  EXPECT_EQ(after.segment, kModelSegment);
  EXPECT_LT(Session::error_mm(after, back_again(3)), 0.03);
}

TEST(Segments, unknown_ground_is_one_segment_tracked_in_its_own_frame) {
  Session s(17);
  for (int n = 0; n < 3; ++n) (void)s.feed(n, hand(seconds_of(n)));
  for (int n = 60; n < 66; ++n) {
    const TrackResult r = s.feed(n, far_off(n - 60));
    EXPECT_EQ(r.segment, 1U) << n;
    EXPECT_EQ(r.state, n == 60 ? TrackState::kStarted : TrackState::kTracking) << n;
    EXPECT_LT(ts::point_error_mm(far_off(0) * r.T_model_cam, far_off(n - 60)), 0.03) << n;
  }
  EXPECT_EQ(s.tracker().segments().size(), 2U);
}

TEST(Segments, what_was_scanned_apart_is_joined_when_the_hand_returns_from_it) {
  Session s(22);
  for (int n = 0; n < 3; ++n) (void)s.feed(n, hand(seconds_of(n)));
  // Apart at first, then over to what is known, without a pause.
  std::vector<TrackResult> apart;
  int n = 60;
  for (double x = 22; x > 0.5; x -= 1.5, ++n) {
    const Pose truth = ts::looking_down(x, 0.5);
    const TrackResult r = s.feed(n, truth);
    ASSERT_NE(r.state, TrackState::kLost) << x;
    if (r.segment == 1U) {
      apart.push_back(r);
      continue;
    }
    ASSERT_EQ(r.segment, kModelSegment);
    if (r.joins.empty()) continue;
    for (std::size_t i = 0; i < apart.size(); ++i) {
      TrackResult moved = apart[i];
      moved.T_model_cam = r.joins[0].T_into_segment * moved.T_model_cam;
      EXPECT_LT(Session::error_mm(moved, ts::looking_down(22 - 1.5 * static_cast<double>(i), 0.5)), 0.1) << i;
    }
  }
  EXPECT_GE(apart.size(), 4U);
  EXPECT_EQ(s.tracker().segments().size(), 1U) << "the segment is part of the model";
}

TEST(Segments, after_the_scan_a_burst_apart_is_found_where_the_model_has_grown_to) {
  const calib::Rig rig = ts::test_rig(4);
  const ts::SyntheticSurface surface(23);
  Tracker tracker(rig, {});
  const auto patch_at = [&](const Pose& T, std::uint64_t key) {
    return ts::make_patch(surface, rig.camera, T, {0.01, 0.03, key});
  };
  // Three bursts apart; then, after another pause, the model goes there. It is found by no burst of its own.
  (void)tracker.track(BurstId{0}, time_of(0), patch_at(hand(0), 1), {});
  std::vector<SurfacePatch> kept;
  std::vector<PlacedBurst> placed;
  for (int n = 0; n < 3; ++n) {
    kept.push_back(patch_at(ts::looking_down(22 + 0.3 * n, 0), 10 + static_cast<std::uint64_t>(n)));
    const auto id = static_cast<std::uint64_t>(60 + n);
    const TrackResult r = tracker.track(BurstId{id}, time_of(60 + n), kept.back(), {});
    placed.push_back({BurstId{id}, r.segment, r.T_model_cam});
    ASSERT_EQ(r.segment, 1U);
  }
  EXPECT_FALSE(tracker.seek(placed[0], kept[0])) << "the model does not reach there yet";
  int n = 0;
  for (double x = 0; x < 22; x += 1.5, ++n)
    (void)tracker.track(BurstId{static_cast<std::uint64_t>(120 + n)}, time_of(120 + n),
                        patch_at(ts::looking_down(x, 0), 100 + static_cast<std::uint64_t>(n)), {});
  std::optional<SegmentJoin> join;
  for (std::size_t i = 0; i < 3 && tracker.segments().size() > 1; ++i) {
    if (const auto now = tracker.seek(placed[i], kept[i])) join = now;
  }
  EXPECT_EQ(tracker.segments().size(), 1U);
}

std::size_t apart_keyframes(const Tracker& tracker) {
  std::size_t out = 0;
  for (const SegmentMemory& s : tracker.segments()) out += s.id == kModelSegment ? 0 : s.keyframes.all().size();
  return out;
}

TEST(Segments, the_smallest_apart_are_forgotten_and_still_join_the_model_at_the_end) {
  TrackerConfig config;
  config.max_apart_keyframes = 4;
  const calib::Rig rig = ts::test_rig(4);
  const ts::SyntheticSurface surface(24);
  Tracker tracker(rig, config);
  std::uint64_t burst = 0;
  const auto feed = [&](const Pose& T, int n) {
    const SurfacePatch patch = ts::make_patch(surface, rig.camera, T, {0.01, 0.03, burst + 1});
    const TrackResult r = tracker.track(BurstId{burst}, time_of(n), patch, {});
    return std::pair{PlacedBurst{BurstId{burst++}, r.segment, r.T_model_cam}, patch};
  };
  (void)feed(ts::looking_down(0, 0), 0);
  // Four bursts in a row that are one segment, then one burst a second, each where nothing is known.
  SegmentId large = kModelSegment;
  for (int n = 0; n < 4; ++n) large = feed(ts::looking_down(24 + 1.5 * n, 0), 60 + n).first.segment;
  ASSERT_EQ(large, 1U);
  ASSERT_GE(apart_keyframes(tracker), 2U);
  std::vector<std::pair<PlacedBurst, SurfacePatch>> singles;
  for (int k = 0; k < 6; ++k) {
    singles.push_back(feed(ts::looking_down(0, 40 + 24.0 * k), 120 + 60 * k));
    EXPECT_LE(apart_keyframes(tracker), 4U);
  }
  const auto remembered = [&](SegmentId id) {
    return std::ranges::find(tracker.segments(), id, &SegmentMemory::id) != tracker.segments().end();
  };
  EXPECT_TRUE(remembered(large)) << "small ones go first";
  const PlacedBurst& gone = singles.front().first;
  EXPECT_FALSE(remembered(gone.segment));
  // The model grows to where the forgotten one lies.
  for (int k = 0; k <= 24; ++k) (void)feed(ts::looking_down(0, 1.8 * k), 900 + k);
  std::optional<SegmentJoin> join;
  for (std::uint64_t vote = 0; vote < 3 && !join; ++vote) {
    PlacedBurst again = gone;
    again.id = BurstId{1000 + vote};
    join = tracker.seek(again, singles.front().second);
  }
  ASSERT_TRUE(join);
  EXPECT_EQ(join->segment, gone.segment);
  EXPECT_EQ(join->into, kModelSegment);
  EXPECT_TRUE(remembered(large));
}

}  // namespace
}  // namespace enamel::pipeline
