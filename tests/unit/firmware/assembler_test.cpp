// One named test for each fault that needs no hardware.
#include "firmware/acquire/assembler.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

#include "tests/unit/firmware/assembler_fault.hpp"

namespace enamel::fw::test {
namespace {

using proto::DropReason;
using testing::ElementsAre;

TEST_F(AssemblerFault, none_loses_nothing) {
  run.run();
  EXPECT_EQ(run.bursts.size(), kBursts);
  expect_others_whole();
}

TEST_F(AssemblerFault, frame_dropped_by_driver_with_sequence_gap) {
  harm_at(2, [](SimStep& s) { s.frames.clear(); });
  expect_lost_for(DropReason::kSeqGap);
}

TEST_F(AssemblerFault, frame_dropped_without_sequence_gap) {
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

TEST_F(AssemblerFault, duplicate_buffer_with_its_old_stamps) {
  harm_at(1, [](SimStep& s) { s.frames.push_back(s.frames.front()); });
  expect_lost_for(DropReason::kSeqGap);
}

TEST_F(AssemblerFault, duplicate_buffer_counted_as_a_new_frame) {
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

TEST_F(AssemblerFault, stale_content_under_fresh_stamps) {
  auto before = std::make_shared<PixelLoan>();
  SimFaults faults;
  faults.on_step = [before](SimStep& s) {
    if (s.position == 2 && s.burst_index == kVictim) s.frames.front().pixels = *before;
    if (!s.frames.empty()) *before = s.frames.front().pixels;
  };
  run.device().set_faults(faults);
  expect_lost_for(DropReason::kDupContent);
}

TEST_F(AssemblerFault, out_of_order_completion) {
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

TEST_F(AssemblerFault, frame_error_inside_a_burst) {
  harm_at(3, [](SimStep& s) { s.frames.front().status = FrameStatus::kError; });
  expect_lost_for(DropReason::kFrameStatus);
}

TEST_F(AssemblerFault, sentinel_with_error_status) {
  harm_at(SimStep::kSentinel, [](SimStep& s) { s.frames.front().status = FrameStatus::kError; });
  expect_lost_for(DropReason::kFrameStatus);
}

TEST(Assembler, first_frames_after_start_are_not_used) {
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

TEST_F(AssemblerFault, frame_of_another_size) {
  harm_at(1, [](SimStep& s) {
    const auto all = s.frames.front().pixels.bytes();
    s.frames.front().pixels = PixelLoan(std::vector<std::uint8_t>(all.begin(), all.end() - 1));
  });
  expect_lost_for(DropReason::kEncode);
}

TEST_F(AssemblerFault, clock_step_in_the_edge_stream) {
  harm_at(1, [](SimStep& s) {
    for (Edge& e : s.edges) e.t += std::chrono::hours(1);
  });
  expect_lost_for(DropReason::kNoStrobe);
}

TEST_F(AssemblerFault, camera_falls_silent) {
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

TEST(Assembler, associates_the_same_whatever_the_order_of_arrival) {
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
      EXPECT_THAT(burst->frames[k].frame.pixels.bytes(),
                  testing::ElementsAreArray(straight.bursts[b].frames[k].frame.pixels.bytes()));
    }
  }
}

TEST(Assembler, tolerance_follows_the_scatter_that_a_devices_stamps_may_have) {
  const CameraMode mode{16, 2, 8, Nanoseconds{200'000'000}, 50'000};
  const auto tolerance = [&](std::int64_t spread_us) {
    return AssemblerConfig::for_mode(mode, Nanoseconds{0}, Nanoseconds{spread_us * 1000}).tol_period;
  };
  EXPECT_EQ(AssemblerConfig::for_mode(mode, Nanoseconds{0}).tol_period, mode.frame_period / 40);
  EXPECT_EQ(tolerance(100), mode.frame_period / 40);
  EXPECT_EQ(tolerance(10), mode.frame_period / 40);
  EXPECT_EQ(tolerance(2'100), mode.frame_period / 40 + Nanoseconds{10'000'000});
  EXPECT_EQ(tolerance(50'000), mode.frame_period / 5) << "frames stay apart";
}

TEST(Assembler, abort_ends_every_opened_gate) {
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
