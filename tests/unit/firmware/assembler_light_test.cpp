// One named test for each fault of strobe, projector and light.
#include <gmock/gmock.h>

#include "tests/unit/firmware/assembler_fault.hpp"

namespace enamel::fw::test {
namespace {

using proto::DropReason;
using testing::ElementsAre;

TEST_F(AssemblerFault, strobe_edge_lost) {
  harm_at(1, [](SimStep& s) { erase_edges(s, EdgeKind::kStrobe); });
  expect_lost_for(DropReason::kNoStrobe);
}

TEST_F(AssemblerFault, strobe_of_the_first_lit_frame_lost) {
  harm_at(0, [](SimStep& s) { erase_edges(s, EdgeKind::kStrobe); });
  expect_lost_for(DropReason::kNoStrobe);
}

TEST_F(AssemblerFault, extra_strobe_is_harmless) {
  harm_at(1, [](SimStep& s) { s.edges.push_back({EdgeKind::kStrobe, s.edges.front().t + Nanoseconds{300'000}, 0}); });
  run.run();
  EXPECT_TRUE(run.given_up.empty());
  expect_others_whole();
}

TEST_F(AssemblerFault, trigger_missed_because_projector_was_not_ready) {
  SimFaults faults;
  faults.trigger_missed = [](std::uint64_t burst, int position) { return burst == kVictim && position == 0; };
  run.device().set_faults(faults);
  run.run();
  ASSERT_FALSE(run.given_up.empty());
  EXPECT_EQ(run.given_up[0].burst_index, kVictim);
  EXPECT_EQ(run.given_up[0].reason, DropReason::kOrder);
  EXPECT_EQ(run.given_up.size(), 1U);  // the restart of the projector brings the next burst back in step
  expect_others_whole();
}

TEST_F(AssemblerFault, projector_never_starts) {
  SimFaults faults;
  faults.trigger_missed = [](std::uint64_t burst, int) { return burst == kVictim; };
  run.device().set_faults(faults);
  expect_lost_for(DropReason::kTimeout);
}

TEST_F(AssemblerFault, projector_restarts_inside_a_burst) {
  harm_at(2, [](SimStep& s) { s.edges.push_back({EdgeKind::kT1, s.edges.front().t + Nanoseconds{1000}, 0}); });
  expect_lost_for(DropReason::kOrder);
}

TEST_F(AssemblerFault, pattern_index_slips) {
  harm_at(0, [](SimStep& s) { erase_edges(s, EdgeKind::kT1); });
  expect_lost_for(DropReason::kOrder);
}

TEST_F(AssemblerFault, pattern_edge_lost_leaves_a_bright_frame_that_claims_to_be_dark) {
  harm_at(1, [](SimStep& s) { erase_edges(s, EdgeKind::kT2Rise); });
  expect_lost_for(DropReason::kDarkLeak);
}

TEST_F(AssemblerFault, two_patterns_in_one_exposure) {
  harm_at(1, [](SimStep& s) {
    const DeviceTime t = s.edges.front().t;
    s.edges.push_back({EdgeKind::kT2Rise, t + Nanoseconds{3'620'000}, 0});
    s.edges.push_back({EdgeKind::kT2Fall, t + Nanoseconds{3'640'000}, 0});
  });
  expect_lost_for(DropReason::kMulti);
}

TEST_F(AssemblerFault, exposure_clipped_by_the_frame_duration_limit) {
  harm_at(0, [](SimStep& s) {
    s.frames.front().exposure_us = 3000;
    s.frames.front().t_sensor -= Nanoseconds{700'000};
  });
  run.run();
  ASSERT_EQ(run.given_up.size(), 1U);
  // Its stamp moves with the end of exposure, so the period check sees it first.
  EXPECT_THAT(run.given_up[0].reason, testing::AnyOf(DropReason::kPartial, DropReason::kPeriod));
  expect_others_whole();
}

TEST_F(AssemblerFault, pattern_still_lit_when_the_exposure_ends) {
  harm_at(2, [](SimStep& s) {
    for (Edge& e : s.edges) {
      if (e.kind == EdgeKind::kT2Fall) e.t += Nanoseconds{100'000};
    }
  });
  expect_lost_for(DropReason::kPartial);
}

TEST_F(AssemblerFault, exposure_changed_inside_a_burst) {
  harm_at(2, [](SimStep& s) { s.frames.front().exposure_us = 3690; });
  expect_lost_for(DropReason::kSettling);
}

TEST_F(AssemblerFault, ambient_light_in_the_sentinel) {
  harm_at(SimStep::kSentinel, [](SimStep& s) {
    PixelLoan& pixels = s.frames.front().pixels;
    pixels = PixelLoan(std::vector<std::uint8_t>(pixels.bytes().size(), 60));
  });
  expect_lost_for(DropReason::kDarkLeak);
}

TEST_F(AssemblerFault, led_stuck_on_shows_in_dark_frames) {
  run.device().set_faults({.on_step = {}, .trigger_missed = {}, .led_open = false, .led_stuck_on = true});
  for (int i = 0; i < 12; ++i) run.step();
  EXPECT_GE(run.assembler().dark_leaks(), 3);
  EXPECT_TRUE(run.bursts.empty());
}

}  // namespace
}  // namespace enamel::fw::test
