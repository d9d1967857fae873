#include "firmware/device/sim/sim_device.hpp"

#include <gmock/gmock.h>

#include "tests/unit/firmware/device_run.hpp"

namespace enamel::fw::test {
namespace {

TEST(SimDevice, keeps_the_sources_time_differences_to_the_nanosecond) {
  DeviceRun run({.count = 5, .distances_ns = {33'333'333, 40'000'001}});
  run.run();
  ASSERT_EQ(run.bursts.size(), 5U);
  const std::int64_t base = to_ns(run.bursts[0].frames[0].t_strobe);
  std::int64_t expected = 0;
  for (std::size_t b = 0; b < 5; ++b) {
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(to_ns(run.bursts[b].frames[k].t_strobe) - base, expected + static_cast<std::int64_t>(k) * kPeriodNs);
    }
    expected += b % 2 == 0 ? 33'333'333 : 40'000'001;
  }
  EXPECT_EQ(run.device().stretched().times, 0U);
}

TEST(SimDevice, every_second_burst_may_be_exposed_shorter) {
  DeviceRun run({.count = 6, .exposures_us = {3700, 925}});
  run.run();
  ASSERT_EQ(run.bursts.size(), 6U) << "none is lost to the change";
  for (std::size_t b = 0; b < 6; ++b) {
    for (const LitFrame& f : run.bursts[b].frames) EXPECT_EQ(f.frame.exposure_us, b % 2 == 0 ? 3700U : 925U);
  }
  DeviceRun absurd({.count = 6, .exposures_us = {3700, 9000}});
  absurd.run();
  EXPECT_EQ(absurd.bursts.size(), 1U) << "longer than the frame period";
}

TEST(SimDevice, delivers_no_frame_before_its_exposure_ends) {
  DeviceRun run({.count = 3});
  ASSERT_TRUE(run.device().arm().has_value());
  for (int i = 0; i < 30; ++i) {
    const auto frame = run.device().next_frame();
    if (!frame) break;
    EXPECT_GE(to_ns(run.clock().now()), to_ns(frame->t_sensor));
  }
}

TEST(SimDevice, every_burst_has_a_dark_frame_just_before_it) {
  DeviceRun run({.count = 20, .distances_ns = {20'020'000, 33'333'333, 24'100'000}});
  std::vector<int> positions;
  run.device().set_faults({.on_step = [&](SimStep& s) { positions.push_back(s.position); }, .trigger_missed = {}});
  run.run();
  EXPECT_EQ(run.bursts.size(), 20U);
  for (std::size_t i = 1; i < positions.size(); ++i) {
    if (positions[i] == 0) {
      EXPECT_EQ(positions[i - 1], SimStep::kSentinel);
    }
  }
}

TEST(SimDevice, frames_are_dark_while_the_light_is_off) {
  DeviceRun run({.count = 2});
  run.device().set_enabled(false);
  run.run();
  ASSERT_EQ(run.bursts.size(), 2U);
  for (const LitFrame& f : run.bursts[0].frames) EXPECT_THAT(f.frame.pixels.bytes(), testing::Each(testing::Eq(2)));
}

TEST(SimDevice, shows_nothing_until_armed) {
  DeviceRun run({.count = 2});
  for (int i = 0; i < 50; ++i) {
    const auto frame = run.device().next_frame();
    ASSERT_TRUE(frame.has_value());
    EXPECT_THAT(frame->pixels.bytes(), testing::Each(testing::Eq(2)));
  }
  std::vector<Edge> edges;
  (void)run.device().read(edges);
  EXPECT_THAT(edges, testing::Each(testing::Field(&Edge::kind, EdgeKind::kStrobe)));
}

TEST(SimDevice, slow_motion_scales_every_time_alike) {
  SimConfig sim = DeviceRun::virtual_time();
  sim.speed = 0.5;
  DeviceRun run({.count = 2}, sim);
  run.run();
  ASSERT_EQ(run.bursts.size(), 2U);
  EXPECT_EQ(run.device().mode().frame_period.count(), 2 * kPeriodNs);
  EXPECT_EQ(run.bursts[0].frames[0].frame.exposure_us, 7400U);
  EXPECT_EQ((run.bursts[1].frames[0].t_strobe - run.bursts[0].frames[0].t_strobe).count(), 66'666'666);
}

TEST(SimDevice, says_by_how_much_a_slow_machine_stretched_time) {
  DeviceRun run({.count = 6});
  while (run.bursts.size() < 3 && run.step()) {
  }
  run.clock().sleep_for(Nanoseconds{500'000'000});  // the machine was busy elsewhere
  run.run();
  ASSERT_EQ(run.bursts.size(), 6U);
  EXPECT_EQ(run.device().stretched().times, 1U);
  EXPECT_GT(run.device().stretched().total.count(), 350'000'000);
  EXPECT_TRUE(run.given_up.empty());
}

TEST(SimDevice, pause_is_not_stretching) {
  DeviceRun run({.count = 6});
  while (run.bursts.size() < 3 && run.step()) {
  }
  run.pause(Nanoseconds{5'000'000'000});
  run.run();
  EXPECT_EQ(run.device().stretched().times, 0U);
  EXPECT_GE(run.bursts.size(), 5U);  // a burst that the stop cut off is gone
}

TEST(SimDevice, refuses_times_that_cannot_be) {
  class Still final : public BurstSource {
   public:
    [[nodiscard]] const std::string& rig_text() const override { return rig_; }
    [[nodiscard]] std::optional<std::uint64_t> count() const override { return 1; }
    [[nodiscard]] Result<std::optional<SimBurst>> next() override {
      SimBurst b;
      b.exposure_us = 3700;
      return std::optional(b);
    }
    std::string rig_;
  };
  VirtualClock clock;
  const auto device = SimDevice::create(std::make_unique<Still>(), clock, {});
  ASSERT_FALSE(device.has_value());
  EXPECT_EQ(device.error().code, ErrorCode::kConfigValue);
}

TEST(SimDevice, an_empty_source_is_an_error) {
  VirtualClock clock;
  const auto device = SimDevice::create(std::make_unique<TaggedSource>(TaggedSource::Config{.count = 0}), clock, {});
  ASSERT_FALSE(device.has_value());
  EXPECT_EQ(device.error().code, ErrorCode::kEmptyInput);
}

}  // namespace
}  // namespace enamel::fw::test
