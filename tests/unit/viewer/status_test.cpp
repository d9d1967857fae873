// Words, colours, keys, mailbox.
#include "viewer/scene/status.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>
#include <thread>

#include "protocol/base/latest_slot.hpp"
#include "viewer/scene/colour.hpp"
#include "viewer/scene/keys.hpp"

namespace enamel::view::test {
namespace {

PreviewFrame scanning(TrackState state) {
  PreviewFrame frame;
  frame.state = ScanState::kScanning;
  frame.placed = true;
  frame.track = state;
  return frame;
}

TEST(StatusLine, green_amber_red_with_different_words) {
  EXPECT_EQ(status_line(scanning(TrackState::kTracking)).colour, kGood);
  EXPECT_EQ(status_line(scanning(TrackState::kRelocalised)).colour, kWeak);
  EXPECT_EQ(status_line(scanning(TrackState::kLost)).colour, kBad);
  std::set<std::string_view> words;
  for (const TrackState state : {TrackState::kTracking, TrackState::kRelocalised, TrackState::kLost}) {
    words.insert(status_line(scanning(state)).title);
  }
  EXPECT_EQ(words.size(), 3U);
  EXPECT_FALSE(status_line(scanning(TrackState::kLost)).hint.empty());
}

TEST(StatusLine, a_segment_apart_has_words_and_a_tone_of_its_own) {
  PreviewFrame frame = scanning(TrackState::kTracking);
  frame.segment = 2;
  const StatusLine apart = status_line(frame);
  EXPECT_EQ(apart.title, "NEW PLACE");
  EXPECT_FALSE(apart.hint.empty());
  for (const Colour& other : {kGood, kWeak, kBad}) EXPECT_NE(apart.colour, other);
}

TEST(StatusLine, a_surface_that_does_not_determine_the_motion_is_told) {
  PreviewFrame frame = scanning(TrackState::kTracking);
  frame.undetermined = true;
  EXPECT_EQ(status_line(frame).title, "TOO SMOOTH");
  EXPECT_EQ(status_line(frame).colour, kWeak);
  EXPECT_FALSE(status_line(frame).hint.empty());
}

TEST(StatusLine, what_is_in_the_way_is_told_with_what_to_do) {
  PreviewFrame frame = scanning(TrackState::kTracking);
  std::set<std::string> titles{std::string(status_line(frame).title)};
  for (std::size_t t = 1; t < kSightTroubles; ++t) {
    frame.sight.trouble = static_cast<SightTrouble>(t);
    EXPECT_TRUE(titles.emplace(status_line(frame).title).second) << t;
    EXPECT_EQ(status_line(frame).colour, kWeak);
    EXPECT_FALSE(status_line(frame).hint.empty());
  }
  frame = scanning(TrackState::kLost);
  for (const char* why : {"", "too_fast", "saturated", "other_light", "no_fringes"}) {
    frame.rejected = why;
    EXPECT_TRUE(titles.emplace(status_line(frame).title).second || std::string_view(why) == "other_light") << why;
    EXPECT_EQ(status_line(frame).colour, kBad);
  }
}

TEST(StatusLine, after_the_last_burst_it_says_how_far_the_refinement_is_and_then_what_is_known) {
  PreviewFrame frame = scanning(TrackState::kTracking);
  frame.state = ScanState::kRefining;
  frame.refined = 0.424;
  EXPECT_EQ(status_line(frame).title, "REFINING THE MODEL");
  EXPECT_EQ(status_line(frame).hint, "42.4 %");
  frame.state = ScanState::kFinished;
  frame.result = "50.5 mm from end to end, known to +-9 um";
  EXPECT_EQ(status_line(frame).hint, frame.result);
}

TEST(StatusLine, little_overlap_is_weak_and_unknown_overlap_is_not) {
  PreviewFrame frame = scanning(TrackState::kTracking);
  frame.track_overlap = std::nan("");
  EXPECT_EQ(status_line(frame).colour, kGood);
  frame.track_overlap = kWeakOverlap - 0.05;
  EXPECT_EQ(status_line(frame).colour, kWeak);
  frame.track_overlap = kWeakOverlap + 0.05;
  EXPECT_EQ(status_line(frame).colour, kGood);
}

TEST(StatusLine, scan_state_comes_before_tracking) {
  PreviewFrame frame = scanning(TrackState::kTracking);
  frame.state = ScanState::kProbeLost;
  EXPECT_EQ(status_line(frame).colour, kBad);
  EXPECT_EQ(status_line(frame).title, "PROBE LOST");
  frame.state = ScanState::kPaused;
  EXPECT_EQ(status_line(frame).title, "PAUSED");
  frame.state = ScanState::kFinished;
  EXPECT_EQ(status_line(frame).title, "SCAN FINISHED");
  EXPECT_EQ(status_line(PreviewFrame{}).title, "WAITING FOR PROBE");
}

TEST(Distance, zones_and_direction_of_the_advice) {
  const ProbeField field;
  const auto zone = [&](double mm) { return distance_reading(mm, field).zone; };
  EXPECT_EQ(zone(39.9), DistanceZone::kTooNear);
  EXPECT_EQ(zone(42), DistanceZone::kNear);
  EXPECT_EQ(zone(45), DistanceZone::kOptimum);
  EXPECT_EQ(zone(51), DistanceZone::kOptimum);
  EXPECT_EQ(zone(53), DistanceZone::kFar);
  EXPECT_EQ(zone(56.1), DistanceZone::kTooFar);
  EXPECT_EQ(zone(std::nan("")), DistanceZone::kNone);
  EXPECT_EQ(distance_reading(39, field).colour, kBad);
  EXPECT_EQ(distance_reading(48, field).colour, kGood);
  EXPECT_EQ(distance_reading(60, field).colour, kViolet);
  EXPECT_NE(distance_reading(39, field).icon, distance_reading(60, field).icon);
  EXPECT_NE(distance_reading(39, field).words, distance_reading(60, field).words);
}

TEST(Distance, marker_moves_along_the_bar_and_stays_on_it) {
  const ProbeField field;
  double before = -1;
  for (double mm = 36; mm <= 60; mm += 0.5) {
    const DistanceReading reading = distance_reading(mm, field);
    EXPECT_GT(reading.position, before);
    EXPECT_EQ(reading.zone == DistanceZone::kOptimum,
              reading.position >= reading.optimum_from && reading.position <= reading.optimum_to);
    before = reading.position;
  }
  EXPECT_EQ(distance_reading(1, field).position, 0.0);
  EXPECT_EQ(distance_reading(1e9, field).position, 1.0);
}

TEST(Colour, quality_ramp_runs_from_orange_over_white_to_blue) {
  const Colour low = quality_colour(0), middle = quality_colour(0.5F), high = quality_colour(1);
  EXPECT_GT(low.r, low.b + 0.4F);
  EXPECT_GT(std::min({middle.r, middle.g, middle.b}), 0.9F);
  EXPECT_GT(high.b, high.r + 0.4F);
  EXPECT_EQ(quality_colour(std::nanf("")), low);
  EXPECT_EQ(quality_colour(-3), low);
  EXPECT_EQ(quality_colour(7), high);
}

TEST(Colour, state_colours_are_readable_on_the_dark_panel) {
  const Colour panel{0.07F, 0.08F, 0.096F};
  for (const Colour& c : {kGood, kWeak, kBad, kIdle, kViolet, kAccent}) {
    EXPECT_GE(contrast_ratio(c, panel), 4.5);
  }
  EXPECT_NEAR(contrast_ratio({1, 1, 1}, {0, 0, 0}), 21.0, 1e-6);
  EXPECT_LT(contrast_ratio({0.2F, 0.2F, 0.2F}, panel), 4.5);  // the measure can fail
}

TEST(Keys, every_key_once_and_every_action_reachable) {
  std::set<std::pair<int, bool>> keys;
  for (const KeyBinding& binding : key_bindings()) {
    EXPECT_TRUE(keys.emplace(static_cast<int>(binding.key), binding.ctrl).second) << binding.key_text;
    EXPECT_EQ(action_for(binding.key, binding.ctrl), binding.action);
  }
  EXPECT_EQ(action_for(KeyCode::kSpace, false), Action::kToggleScan);
  EXPECT_EQ(action_for(letter('Q'), false), Action::kQualityMap);
  EXPECT_EQ(action_for(letter('Q'), true), Action::kQuit);
  EXPECT_FALSE(action_for(letter('X'), false));
}

TEST(Keys, toggles_flip_and_others_are_left_to_the_owner) {
  DisplayToggles toggles;
  EXPECT_TRUE(apply_toggle(Action::kQualityMap, toggles));
  EXPECT_TRUE(toggles.quality_map);
  EXPECT_TRUE(apply_toggle(Action::kFollow, toggles));
  EXPECT_FALSE(toggles.follow);
  EXPECT_EQ(action_for(letter('P'), false), Action::kStages);
  EXPECT_TRUE(apply_toggle(Action::kStages, toggles));
  EXPECT_TRUE(toggles.stages);
  EXPECT_TRUE(toggles.panels) << "the figures stay";
  EXPECT_EQ(action_for(letter('T'), false), Action::kSoftTissue);
  EXPECT_TRUE(apply_toggle(Action::kSoftTissue, toggles));
  EXPECT_FALSE(toggles.soft_tissue);
  toggles.help = true;
  EXPECT_TRUE(apply_toggle(Action::kCloseHelp, toggles));
  EXPECT_FALSE(toggles.help);
  EXPECT_FALSE(apply_toggle(Action::kToggleScan, toggles));
  EXPECT_FALSE(apply_toggle(Action::kQuit, toggles));
}

TEST(StageLines, say_time_rate_queue_and_what_is_waited_for) {
  PipelineFigures figures;
  figures.stages.push_back({.name = "track",
                            .median_ms = 71.34,
                            .p95_ms = 149.6,
                            .rate_hz = 9.87,
                            .busy = 0.7,
                            .queue_depth = 1,
                            .queue_high_water = 2,
                            .queue_capacity = 2,
                            .waits_for = "decode0"});
  figures.stages.push_back({.name = "fuse", .busy = std::nan(""), .waits_for = ""});
  const auto lines = stage_lines(figures);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].times, "71.3 / 150 ms");
  EXPECT_EQ(lines[0].rest, "9.9 /s, queue 1, most 2 of 2, waits for decode0");
  EXPECT_FLOAT_EQ(lines[0].busy, 0.7F);
  EXPECT_EQ(lines[1].rest, "0.0 /s, queue 0, most 0 of 0") << "nothing is said of a stage that waits for nothing";
  EXPECT_EQ(lines[1].busy, 0.0F);
  EXPECT_TRUE(stage_lines({}).empty());
}

TEST(Grouped, thousands_are_apart) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1 000");
  EXPECT_EQ(grouped(12345678), "12 345 678");
}

using PreviewMailbox = LatestSlot<std::shared_ptr<const PreviewFrame>>;

std::shared_ptr<const PreviewFrame> numbered(std::uint64_t burst) {
  auto frame = std::make_shared<PreviewFrame>();
  frame->burst = BurstId{burst};
  return frame;
}

TEST(Mailbox, viewer_that_never_looks_does_not_hold_the_session_up) {
  PreviewMailbox mailbox;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    mailbox.put(numbered(i));  // nobody takes: would hang here if put could wait
  }
  EXPECT_EQ(mailbox.replaced(), 9'999U);
  const auto newest = mailbox.take();
  ASSERT_TRUE(newest);
  EXPECT_EQ((*newest)->burst.value, 9'999U);
  EXPECT_FALSE(mailbox.take());
}

TEST(Mailbox, slow_viewer_sees_only_newer_frames_and_the_last_one) {
  PreviewMailbox mailbox;
  constexpr std::uint64_t kLast = 20'000;
  std::thread session([&mailbox] {
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      mailbox.put(numbered(i));
    }
  });
  std::uint64_t seen = 0;
  while (seen < kLast) {
    if (const auto frame = mailbox.take()) {
      ASSERT_GT((*frame)->burst.value, seen);
      seen = (*frame)->burst.value;
      std::this_thread::yield();
    }
  }
  session.join();
  EXPECT_EQ(seen, kLast);
}

}  // namespace
}  // namespace enamel::view::test
