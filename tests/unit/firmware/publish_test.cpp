#include <gmock/gmock.h>

#include <condition_variable>
#include <cstring>
#include <mutex>
#include <thread>

#include "firmware/publish/publisher.hpp"
#include "tests/unit/firmware/device_run.hpp"

namespace enamel::fw::test {
namespace {

using proto::DropReason;

constexpr ScanTag kSession{SessionId{7}, 1};

std::vector<AssembledBurst> assembled(std::uint64_t n) {
  DeviceRun run({.count = n});
  run.run();
  return std::move(run.bursts);
}

CapturedBurst captured(AssembledBurst burst, ScanTag session = kSession) {
  BurstPixels pixels = take_pixels(burst);
  return {session, std::move(burst), std::move(pixels), Nanoseconds{kPeriodNs}, 3225, 0};
}

double residual_of(AssembledBurst burst) {
  const CameraFrame& f = burst.frames[0].frame;
  const FrameShape shape{f.width, f.height, f.bit_depth};
  return closure_residual(take_pixels(burst), shape, {});
}

/// Lets writes through one by one, or refuses them.
class GatedSink final : public BurstSink {
 public:
  [[nodiscard]] Result<void> write(const proto::Burst& burst) override {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return tickets_ > 0; });
    --tickets_;
    --waiting_;
    if (refuse_) return fail(ErrorCode::kDds, "refused");
    written_.push_back(burst);
    changed_.notify_all();
    return {};
  }
  void let(int n) {
    const std::lock_guard lock(mutex_);
    tickets_ += n;
    changed_.notify_all();
  }
  void refuse(bool yes) {
    const std::lock_guard lock(mutex_);
    refuse_ = yes;
  }
  void wait_for_writer() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_ > 0; });
  }
  std::vector<proto::Burst> wait_written(std::size_t n) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return written_.size() >= n; });
    return written_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int tickets_ = 0;
  int waiting_ = 0;
  bool refuse_ = false;
  std::vector<proto::Burst> written_;
};

TEST(BurstBuilder, fills_everything_that_travels) {
  const auto bursts = assembled(2);
  BurstBuilderConfig config;
  config.probe_id = 77;
  config.calib_crc32 = 0xABCD;
  const auto burst = build_burst(captured(bursts[1]), config);
  ASSERT_TRUE(burst.has_value());
  EXPECT_TRUE(proto::is_consistent(*burst));
  EXPECT_EQ(burst->probe_id, 77U);
  EXPECT_EQ(burst->session_id, 7U);
  EXPECT_EQ(burst->burst_index, 1U);
  EXPECT_EQ(burst->calib_crc32, 0xABCDU);
  EXPECT_EQ(burst->temp_centi_c, 3225);
  EXPECT_EQ(burst->frame_period_ns, 4'004'000U);
  EXPECT_EQ(burst->t_first_exposure_ns, burst->meta[0].t_strobe_ns);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& m = burst->meta[k];
    EXPECT_EQ(m.pattern_index, k);
    EXPECT_EQ(m.exposure_us, 3700U);
    EXPECT_LT(m.t_strobe_ns, m.t_trig_rise_ns);
    EXPECT_LT(m.t_trig_rise_ns, m.t_trig_fall_ns);
    EXPECT_LT(m.t_trig_fall_ns, m.t_sensor_ns);
    const auto sent = proto::frame_bytes(*burst, static_cast<int>(k));
    EXPECT_THAT(sent, testing::ElementsAreArray(bursts[1].frames[k].frame.pixels.bytes()));
  }
}

AssembledBurst four_frames(int width, int height, const std::function<double(int k, int x)>& level) {
  AssembledBurst b;
  for (int k = 0; k < 4; ++k) {
    CameraFrame& f = b.frames[static_cast<std::size_t>(k)].frame;
    f.width = width;
    f.height = height;
    f.exposure_us = 3700;
    std::vector<std::uint8_t> pixels;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) pixels.push_back(static_cast<std::uint8_t>(level(k, x)));
    }
    f.pixels = PixelLoan(std::move(pixels));
  }
  return b;
}

double fringe(int k, int x) { return 120.0 + 80.0 * std::cos(0.4 * x + k * 1.5707963267948966); }

TEST(BurstBuilder, still_fringes_have_no_motion_flag) {
  const AssembledBurst b = four_frames(320, 64, fringe);
  EXPECT_LT(residual_of(b), 1.0);
  EXPECT_EQ(build_burst(captured(b), {})->meta[0].quality_flags & proto::kFlagMotion, 0);
}

TEST(BurstBuilder, fringes_that_move_between_frames_are_flagged) {
  const AssembledBurst b = four_frames(
      320, 64, [](int k, int x) { return 120.0 + 80.0 * std::cos(0.4 * x + k * 1.5707963267948966 + 0.5 * k * k); });
  EXPECT_GT(residual_of(b), 4.0);
  EXPECT_NE(build_burst(captured(b), {})->meta[3].quality_flags & proto::kFlagMotion, 0);
}

TEST(BurstBuilder, polarity_coded_fringes_are_not_taken_for_motion) {
  const AssembledBurst b = four_frames(320, 64, [](int k, int x) {
    const bool inverted = (x / 48) % 2 == 1;  // frame 3 shows -sin instead of +sin
    return inverted && k == 3 ? 240.0 - fringe(3, x) : fringe(k, x);
  });
  EXPECT_LT(residual_of(b), 1.0);
}

TEST(BurstBuilder, saturation_and_missing_light_are_flagged_not_dropped) {
  AssembledBurst bright = four_frames(32, 32, [](int, int x) { return x < 2 ? 255.0 : 100.0; });
  const auto saturated = build_burst(captured(bright), {});
  EXPECT_NE(saturated->meta[0].quality_flags & proto::kFlagSaturated, 0);
  EXPECT_EQ(saturated->meta[0].saturated_permille, 63);
  AssembledBurst dark = four_frames(32, 32, [](int, int) { return 4.0; });
  dark.ambient_dn = 2;
  EXPECT_NE(build_burst(captured(dark), {})->meta[0].quality_flags & proto::kFlagLowMod, 0);
}

class PublisherTest : public testing::Test {
 protected:
  void SetUp() override {
    ledger.open(kSession);
    bursts = assembled(10);
  }
  void push(std::size_t i, ScanTag session = kSession) {
    ledger.begin(session, 1);
    publisher->push(captured(bursts[i], session));
  }
  VirtualClock clock;
  BurstLedger ledger;
  GatedSink sink;
  std::vector<AssembledBurst> bursts;
  std::unique_ptr<Publisher> publisher = std::make_unique<Publisher>(sink, ledger, clock, PublisherConfig{});
};

TEST_F(PublisherTest, writes_in_order_and_numbers_what_it_writes) {
  sink.let(3);
  for (std::size_t i = 0; i < 3; ++i) {
    push(i);
    sink.wait_written(i + 1);
  }
  const auto written = sink.wait_written(3);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(written[i].burst_seq, i);
    EXPECT_EQ(written[i].burst_index, i);
    EXPECT_GT(written[i].t_publish_ns, 0U);
  }
}

TEST_F(PublisherTest, slow_link_lets_the_oldest_go_and_leaves_no_gap_in_the_sequence) {
  push(0);
  sink.wait_for_writer();
  for (std::size_t i = 1; i < 8; ++i) push(i);  // queue of three: 1..4 go
  const BurstCounts held = ledger.counts();
  EXPECT_EQ(held.dropped[static_cast<std::size_t>(DropReason::kQueueFull)], 4U);
  EXPECT_EQ(held.under_way(), 4U);
  sink.let(4);
  const auto written = sink.wait_written(4);
  EXPECT_EQ(written[0].burst_index, 0U);
  EXPECT_EQ(written[1].burst_index, 5U);
  EXPECT_EQ(written[3].burst_index, 7U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(written[i].burst_seq, i);
}

TEST_F(PublisherTest, refused_writes_are_counted_and_spend_no_number) {
  sink.refuse(true);
  sink.let(1);
  push(0);
  while (ledger.counts().under_way() > 0) std::this_thread::yield();
  sink.refuse(false);
  sink.let(1);
  push(1);
  EXPECT_EQ(sink.wait_written(1)[0].burst_seq, 0U);
  while (ledger.counts().under_way() > 0) std::this_thread::yield();
  const BurstCounts c = ledger.counts();
  EXPECT_EQ(c.dropped[static_cast<std::size_t>(DropReason::kWriteFail)], 1U);
  EXPECT_EQ(c.emitted, 1U);
}

TEST_F(PublisherTest, what_is_queued_at_the_end_is_counted) {
  push(0);
  sink.wait_for_writer();
  push(1);
  push(2);
  std::jthread later([&] { sink.let(3); });  // enough for all: which of them are written before the end is chance
  publisher.reset();
  const BurstCounts c = ledger.counts();
  EXPECT_EQ(c.under_way(), 0U);
  EXPECT_EQ(c.begun, c.emitted + c.dropped_total());
}

TEST_F(PublisherTest, a_new_session_starts_its_own_numbers_and_counts) {
  sink.let(10);
  push(0);
  push(1);
  sink.wait_written(2);
  while (ledger.counts().under_way() > 0) std::this_thread::yield();
  const ScanTag again{SessionId{7}, 2};  // another host, same number
  ledger.open(again);
  push(2, again);
  EXPECT_EQ(sink.wait_written(3)[2].burst_seq, 0U);
  while (ledger.counts().under_way() > 0) std::this_thread::yield();
  EXPECT_EQ(ledger.counts().begun, 1U);
  EXPECT_EQ(ledger.counts().emitted, 1U);
}

TEST_F(PublisherTest, rate_is_that_of_the_last_two_seconds) {
  sink.let(100);
  for (std::size_t i = 0; i < 10; ++i) {
    push(i);
    while (ledger.counts().under_way() > 0) std::this_thread::yield();
    clock.sleep_for(Nanoseconds{50'000'000});
  }
  EXPECT_NEAR(publisher->rates().burst_rate_chz, 2000, 10);
  clock.sleep_for(Nanoseconds{3'000'000'000});
  EXPECT_EQ(publisher->rates().burst_rate_chz, 0);
}

}  // namespace
}  // namespace enamel::fw::test
