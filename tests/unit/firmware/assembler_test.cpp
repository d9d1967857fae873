// One named test for each fault that needs no hardware.
#include "firmware/acquire/assembler.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

#include "tests/unit/firmware/device_run.hpp"

namespace enamel::fw::test {
namespace {

using proto::DropReason;
using testing::ElementsAre;

constexpr std::uint64_t kVictim = 3;
constexpr std::uint64_t kBursts = 8;

/// Plays eight bursts; `harm` changes the steps of burst 3, or of the sentinel before it.
class AssemblerFault : public testing::Test {
 protected:
  void harm_at(int position, std::function<void(SimStep&)> harm) {
    SimFaults faults;
    faults.on_step = [position, harm = std::move(harm)](SimStep& s) {
      if (s.position == position && s.burst_index == kVictim) harm(s);
    };
    run.device().set_faults(std::move(faults));
  }
  /// Only the victim is lost, for this reason; every other burst is whole and holds its own frames.
  void expect_lost_for(DropReason reason) {
    run.run();
    ASSERT_EQ(run.given_up.size(), 1U);
    EXPECT_EQ(run.given_up[0].burst_index, kVictim);
    EXPECT_EQ(run.given_up[0].reason, reason) << name_of(run.given_up[0].reason);
    expect_others_whole();
  }
  void expect_others_whole() {
    EXPECT_EQ(run.bursts.size() + run.given_up.size(), kBursts);
    EXPECT_EQ(run.assembler().begun(), kBursts);
    EXPECT_EQ(run.assembler().under_way(), 0U);
    for (const AssembledBurst& b : run.bursts) {
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_EQ(tag_of(b.frames[k].frame.pixels), std::pair(b.burst_index, static_cast<int>(k)));
      }
    }
  }
  static void erase_edges(SimStep& s, EdgeKind kind) {
    std::erase_if(s.edges, [&](const Edge& e) { return e.kind == kind; });
  }

  DeviceRun run{TaggedSource::Config{.count = kBursts}};
};

TEST_F(AssemblerFault, NoneLosesNothing) {
  run.run();
  EXPECT_EQ(run.bursts.size(), kBursts);
  expect_others_whole();
}

TEST_F(AssemblerFault, FrameDroppedByDriverWithSequenceGap) {
  harm_at(2, [](SimStep& s) { s.frames.clear(); });
  expect_lost_for(DropReason::kSeqGap);
}

TEST_F(AssemblerFault, FrameDroppedWithoutSequenceGap) {
  auto hidden = std::make_shared<std::uint32_t>(0U);
  SimFaults faults;
  faults.on_step = [hidden](SimStep& s) {
    for (CameraFrame& f : s.frames) f.sensor_seq -= *hidden;
    if (s.position != 2 || s.burst_index != kVictim) return;
    s.frames.clear();
    ++*hidden;
  };
  run.device().set_faults(faults);
  expect_lost_for(DropReason::kPeriod);
}

TEST_F(AssemblerFault, DuplicateBufferWithItsOldStamps) {
  harm_at(1, [](SimStep& s) { s.frames.push_back(s.frames.front()); });
  expect_lost_for(DropReason::kSeqGap);
}

TEST_F(AssemblerFault, DuplicateBufferCountedAsANewFrame) {
  auto extra = std::make_shared<std::uint32_t>(0U);
  SimFaults faults;
  faults.on_step = [extra](SimStep& s) {
    for (CameraFrame& f : s.frames) f.sensor_seq += *extra;
    if (s.position != 1 || s.burst_index != kVictim) return;
    CameraFrame again = s.frames.front();
    ++again.sensor_seq;
    ++*extra;
    s.frames.push_back(again);
  };
  run.device().set_faults(faults);
  expect_lost_for(DropReason::kPeriod);
}

TEST_F(AssemblerFault, StaleContentUnderFreshStamps) {
  auto before = std::make_shared<std::vector<std::uint8_t>>();
  SimFaults faults;
  faults.on_step = [before](SimStep& s) {
    if (s.position == 2 && s.burst_index == kVictim) s.frames.front().pixels = *before;
    if (!s.frames.empty()) *before = s.frames.front().pixels;
  };
  run.device().set_faults(faults);
  expect_lost_for(DropReason::kDupContent);
}

TEST_F(AssemblerFault, OutOfOrderCompletion) {
  auto held = std::make_shared<std::optional<CameraFrame>>();
  SimFaults faults;
  faults.on_step = [held](SimStep& s) {
    if (s.position == 1 && s.burst_index == kVictim) {
      *held = std::move(s.frames.front());
      s.frames.clear();
    } else if (*held) {
      s.frames.push_back(*std::exchange(*held, std::nullopt));
    }
  };
  run.device().set_faults(faults);
  expect_lost_for(DropReason::kSeqGap);
}

TEST_F(AssemblerFault, FrameErrorInsideABurst) {
  harm_at(3, [](SimStep& s) { s.frames.front().status = FrameStatus::kError; });
  expect_lost_for(DropReason::kFrameStatus);
}

TEST_F(AssemblerFault, SentinelWithErrorStatus) {
  harm_at(SimStep::kSentinel, [](SimStep& s) { s.frames.front().status = FrameStatus::kError; });
  expect_lost_for(DropReason::kFrameStatus);
}

TEST(Assembler, FirstFramesAfterStartAreNotUsed) {
  SimConfig sim = DeviceRun::virtual_time();
  sim.startup_frames = 40;
  DeviceRun run({.count = 2}, sim);
  std::vector<FrameStatus> before_first_gate;
  SimFaults faults;
  faults.on_step = [&](SimStep& s) {
    if (s.position == SimStep::kFreeRunning && run.assembler().begun() == 0)
      before_first_gate.push_back(s.frames[0].status);
  };
  run.device().set_faults(faults);
  run.run();
  EXPECT_EQ(std::count(before_first_gate.begin(), before_first_gate.end(), FrameStatus::kStartup), 40);
  EXPECT_GE(before_first_gate.size(), 43U);  // and three good ones to settle
  EXPECT_EQ(run.bursts.size(), 2U);
}

TEST_F(AssemblerFault, StrobeEdgeLost) {
  harm_at(1, [](SimStep& s) { erase_edges(s, EdgeKind::kStrobe); });
  expect_lost_for(DropReason::kNoStrobe);
}

TEST_F(AssemblerFault, StrobeOfTheFirstLitFrameLost) {
  harm_at(0, [](SimStep& s) { erase_edges(s, EdgeKind::kStrobe); });
  expect_lost_for(DropReason::kNoStrobe);
}

TEST_F(AssemblerFault, ExtraStrobeIsHarmless) {
  harm_at(1, [](SimStep& s) { s.edges.push_back({EdgeKind::kStrobe, s.edges.front().t + Nanoseconds{300'000}, 0}); });
  run.run();
  EXPECT_TRUE(run.given_up.empty());
  expect_others_whole();
}

TEST_F(AssemblerFault, TriggerMissedBecauseProjectorWasNotReady) {
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

TEST_F(AssemblerFault, ProjectorNeverStarts) {
  SimFaults faults;
  faults.trigger_missed = [](std::uint64_t burst, int) { return burst == kVictim; };
  run.device().set_faults(faults);
  expect_lost_for(DropReason::kTimeout);
}

TEST_F(AssemblerFault, ProjectorRestartsInsideABurst) {
  harm_at(2, [](SimStep& s) { s.edges.push_back({EdgeKind::kT1, s.edges.front().t + Nanoseconds{1000}, 0}); });
  expect_lost_for(DropReason::kOrder);
}

TEST_F(AssemblerFault, PatternIndexSlips) {
  harm_at(0, [](SimStep& s) { erase_edges(s, EdgeKind::kT1); });
  expect_lost_for(DropReason::kOrder);
}

TEST_F(AssemblerFault, PatternEdgeLostLeavesABrightFrameThatClaimsToBeDark) {
  harm_at(1, [](SimStep& s) { erase_edges(s, EdgeKind::kT2Rise); });
  expect_lost_for(DropReason::kDarkLeak);
}

TEST_F(AssemblerFault, TwoPatternsInOneExposure) {
  harm_at(1, [](SimStep& s) {
    const DeviceTime t = s.edges.front().t;
    s.edges.push_back({EdgeKind::kT2Rise, t + Nanoseconds{3'620'000}, 0});
    s.edges.push_back({EdgeKind::kT2Fall, t + Nanoseconds{3'640'000}, 0});
  });
  expect_lost_for(DropReason::kMulti);
}

TEST_F(AssemblerFault, ExposureClippedByTheFrameDurationLimit) {
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

TEST_F(AssemblerFault, PatternStillLitWhenTheExposureEnds) {
  harm_at(2, [](SimStep& s) {
    for (Edge& e : s.edges) {
      if (e.kind == EdgeKind::kT2Fall) e.t += Nanoseconds{100'000};
    }
  });
  expect_lost_for(DropReason::kPartial);
}

TEST_F(AssemblerFault, ExposureChangedInsideABurst) {
  harm_at(2, [](SimStep& s) { s.frames.front().exposure_us = 3690; });
  expect_lost_for(DropReason::kSettling);
}

TEST_F(AssemblerFault, AmbientLightInTheSentinel) {
  harm_at(SimStep::kSentinel, [](SimStep& s) {
    for (auto& v : s.frames.front().pixels) v = 60;
  });
  expect_lost_for(DropReason::kDarkLeak);
}

TEST_F(AssemblerFault, LedStuckOnShowsInDarkFrames) {
  run.device().set_faults({.on_step = {}, .trigger_missed = {}, .led_open = false, .led_stuck_on = true});
  for (int i = 0; i < 12; ++i) run.step();
  EXPECT_GE(run.assembler().dark_leaks(), 3);
  EXPECT_TRUE(run.bursts.empty());
}

TEST_F(AssemblerFault, FrameOfAnotherSize) {
  harm_at(1, [](SimStep& s) { s.frames.front().pixels.pop_back(); });
  expect_lost_for(DropReason::kEncode);
}

TEST_F(AssemblerFault, ClockStepInTheEdgeStream) {
  harm_at(1, [](SimStep& s) {
    for (Edge& e : s.edges) e.t += std::chrono::hours(1);
  });
  expect_lost_for(DropReason::kNoStrobe);
}

TEST_F(AssemblerFault, CameraFallsSilent) {
  SimFaults faults;
  faults.on_step = [](SimStep& s) {
    if (s.position >= 1 && s.burst_index == kVictim) s.frames.clear();
  };
  run.device().set_faults(faults);
  run.run();
  ASSERT_EQ(run.given_up.size(), 1U);
  EXPECT_THAT(run.given_up[0].reason, testing::AnyOf(DropReason::kSeqGap, DropReason::kTimeout));
  expect_others_whole();
}

TEST(Assembler, AssociatesTheSameWhateverTheOrderOfArrival) {
  // All edges of a burst come before, or all after, its frames.
  DeviceRun straight({.count = 3});
  std::vector<Edge> edges;
  std::vector<CameraFrame> frames;
  straight.device().set_faults({.on_step =
                                    [&](SimStep& s) {
                                      edges.insert(edges.end(), s.edges.begin(), s.edges.end());
                                      frames.insert(frames.end(), s.frames.begin(), s.frames.end());
                                    },
                                .trigger_missed = {}});
  straight.run();
  ASSERT_EQ(straight.bursts.size(), 3U);
  BurstAssembler late(AssemblerConfig::for_mode(straight.device().mode(), Nanoseconds{20'000}));
  std::size_t next = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    late.push_frame(frames[i]);
    if (i % 2 == 0) continue;  // the edges of two frames come together, latest first
    const DeviceTime until = frames[i].t_sensor;
    std::size_t end = next;
    while (end < edges.size() && edges[end].t <= until) ++end;
    for (std::size_t e = end; e > next; --e) late.push_edge(edges[e - 1]);
    next = end;
    late.edges_known_until(until);
  }
  const auto outcomes = late.take_outcomes();
  ASSERT_EQ(outcomes.size(), 3U);
  for (std::size_t b = 0; b < 3; ++b) {
    const auto* burst = std::get_if<AssembledBurst>(&outcomes[b]);
    ASSERT_NE(burst, nullptr);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(burst->frames[k].t_strobe, straight.bursts[b].frames[k].t_strobe);
      EXPECT_EQ(burst->frames[k].frame.pixels, straight.bursts[b].frames[k].frame.pixels);
    }
  }
}

TEST(Assembler, AbortEndsEveryOpenedGate) {
  BurstAssembler assembler(AssemblerConfig::for_mode({16, 2, 8, Nanoseconds{kPeriodNs}, 3700}, Nanoseconds{20'000}));
  for (std::uint64_t i = 0; i < 3; ++i) {
    assembler.push_edge({EdgeKind::kGate, device_time(static_cast<std::int64_t>(i) * 30'000'000), i});
  }
  assembler.abort(DropReason::kOther);
  EXPECT_EQ(assembler.take_outcomes().size(), 3U);
  EXPECT_EQ(assembler.under_way(), 0U);
}

}  // namespace
}  // namespace enamel::fw::test
