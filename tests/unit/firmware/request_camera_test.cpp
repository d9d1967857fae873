// A camera made of requests, on a FAKE of libcamera: what users of real ones met (lost, late, repeated and reordered
// frames, controls that act later, buffers that run out, cables pulled).
#include "firmware/device/linux/camera/request_camera.hpp"

#include <gmock/gmock.h>

#include <thread>

#include "firmware/device/linux/camera/stamp_clock.hpp"
#include "tests/unit/firmware/fake_request_source.hpp"

namespace enamel::fw::test {
namespace {

constexpr Nanoseconds kShort{20'000'000};

RequestCameraConfig quick() {
  RequestCameraConfig config;
  config.startup_frames = 2;
  config.missing_periods = 1;
  config.least_wait = kShort;
  config.restarts = 2;
  config.first_pause = Nanoseconds{1'000'000};
  return config;
}

class RequestCameraTest : public testing::Test {
 protected:
  void make(const RequestCameraConfig& config = quick()) {
    auto made = RequestCamera::create(source, clock, config);
    ASSERT_TRUE(made.has_value());
    camera = std::move(*made);
    ASSERT_TRUE(camera->start().has_value());
  }
  CameraFrame next(const std::function<void(Completion&)>& harm = {}) {
    EXPECT_TRUE(source->deliver(harm));
    auto frame = camera->next_frame();
    EXPECT_TRUE(frame.has_value());
    return frame.value_or(CameraFrame{});
  }
  void settle() {
    for (int i = 0; i < quick().startup_frames; ++i) EXPECT_EQ(next().status, FrameStatus::kStartup);
  }

  SteadyClock clock;
  std::shared_ptr<FakeRequestSource> source = std::make_shared<FakeRequestSource>();
  std::unique_ptr<RequestCamera> camera;
};

TEST_F(RequestCameraTest, lends_frames_and_queues_what_comes_back) {
  make();
  EXPECT_EQ(source->queued(), 8U);
  settle();
  for (unsigned i = 2; i < 50; ++i) {
    const CameraFrame frame = next();
    EXPECT_EQ(frame.status, FrameStatus::kSuccess);
    EXPECT_EQ(frame.sensor_seq, i);
    EXPECT_EQ(frame.exposure_us, 3776U);
    EXPECT_THAT(frame.pixels.row(16, 1), testing::Each(testing::Eq(i)));
    EXPECT_EQ(source->queued(), 7U) << "lent";
  }
  EXPECT_EQ(source->queued(), 8U);
  EXPECT_EQ(camera->mode().frame_period, Nanoseconds{4'004'000});
}

TEST_F(RequestCameraTest, frames_in_hand_keep_their_pixels) {
  make();
  std::vector<CameraFrame> held;
  for (int i = 0; i < 7; ++i) held.push_back(next());
  for (unsigned i = 0; i < 20; ++i) next();
  for (unsigned i = 0; i < 7; ++i) EXPECT_THAT(held[i].pixels.row(16, 0), testing::Each(testing::Eq(i)));
}

TEST_F(RequestCameraTest, starved_of_buffers_says_so_and_goes_on_when_they_return) {
  make();
  std::vector<CameraFrame> held;
  for (int i = 0; i < 8; ++i) held.push_back(next());
  const auto none = camera->next_frame();
  ASSERT_FALSE(none.has_value());
  EXPECT_THAT(none.error().detail, testing::HasSubstr("starved"));
  EXPECT_EQ(camera->counts().starved, 1U);
  EXPECT_EQ(camera->counts().restarts, 0U) << "a restart brings no buffer back";
  held.clear();
  EXPECT_EQ(source->queued(), 8U);
  EXPECT_EQ(next().status, FrameStatus::kSuccess);
}

TEST_F(RequestCameraTest, with_few_buffers_frames_are_copied_and_nothing_starves) {
  source = std::make_shared<FakeRequestSource>(4);
  make();
  std::vector<CameraFrame> held;
  for (int i = 0; i < 12; ++i) held.push_back(next());
  EXPECT_EQ(source->queued(), 4U);
  for (unsigned i = 0; i < 12; ++i) EXPECT_THAT(held[i].pixels.row(16, 1), testing::Each(testing::Eq(i)));
}

TEST_F(RequestCameraTest, silent_camera_is_restarted_and_settles_again) {
  make();
  settle();
  const CameraFrame lent = next();
  source->on_queue = [](FakeRequestSource& s) {
    if (s.starts == 2) s.deliver();
  };
  const auto frame = camera->next_frame();
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->status, FrameStatus::kStartup);
  EXPECT_EQ(camera->counts().restarts, 1U);
  EXPECT_EQ(source->stops, 1);
  EXPECT_THAT(lent.pixels.row(16, 0), testing::Each(testing::Eq(2))) << "lent over a restart";
}

TEST_F(RequestCameraTest, camera_that_stays_silent_fails_after_bounded_restarts) {
  make();
  const auto frame = camera->next_frame();
  ASSERT_FALSE(frame.has_value());
  EXPECT_EQ(frame.error().code, ErrorCode::kCamera);
  EXPECT_THAT(frame.error().detail, testing::HasSubstr("2 restarts"));
  EXPECT_EQ(source->starts, 3);
}

TEST_F(RequestCameraTest, buffers_lent_over_a_restart_come_back) {
  make();
  auto held = std::make_unique<CameraFrame>(next());
  camera->stop();
  ASSERT_TRUE(camera->start().has_value());
  EXPECT_EQ(source->queued(), 7U);
  held.reset();
  EXPECT_EQ(source->queued(), 8U);
}

TEST_F(RequestCameraTest, frames_nobody_read_before_a_stop_are_not_lost) {
  make();
  for (int i = 0; i < 5; ++i) source->deliver();
  camera->stop();
  ASSERT_TRUE(camera->start().has_value());
  EXPECT_EQ(source->queued(), 8U);
  EXPECT_EQ(next().sensor_seq, 0U) << "the old ones are not delivered";
}

TEST_F(RequestCameraTest, frame_outlives_its_camera) {
  make();
  const CameraFrame frame = next();
  camera.reset();
  EXPECT_THAT(frame.pixels.row(16, 0), testing::Each(testing::Eq(0)));
}

TEST_F(RequestCameraTest, unplugged_after_what_had_come) {
  make();
  source->deliver();
  source->unplug();
  EXPECT_TRUE(camera->next_frame().has_value());
  const auto gone = camera->next_frame();
  ASSERT_FALSE(gone.has_value());
  EXPECT_THAT(gone.error().detail, testing::HasSubstr("disconnected"));
  camera->stop();
  EXPECT_FALSE(camera->start().has_value());
}

TEST_F(RequestCameraTest, stop_ends_a_wait_on_another_thread) {
  RequestCameraConfig patient = quick();
  patient.least_wait = Nanoseconds{60'000'000'000};
  make(patient);
  const HostTime begin = clock.now();
  std::jthread stopper([&] {
    clock.sleep_for(kShort);
    camera->stop();
  });
  const auto frame = camera->next_frame();
  ASSERT_FALSE(frame.has_value());
  EXPECT_EQ(frame.error().code, ErrorCode::kCancelled);
  EXPECT_LT(clock.now() - begin, Nanoseconds{10'000'000'000});
}

TEST_F(RequestCameraTest, damaged_and_reordered_frames_are_told_and_counted) {
  make();
  settle();
  EXPECT_EQ(next([](Completion& c) { c.status = FrameStatus::kError; }).status, FrameStatus::kError);
  EXPECT_EQ(next([](Completion& c) { c.sequence = 9; }).sensor_seq, 9U);
  EXPECT_EQ(next([](Completion& c) { c.sequence = 8; }).sensor_seq, 8U);
  EXPECT_EQ(camera->counts().errors, 1U);
  EXPECT_EQ(camera->counts().out_of_order, 1U);
}

TEST_F(RequestCameraTest, buffers_of_damaged_frames_wait_for_a_sound_one) {
  make();
  settle();
  const auto damage = [](Completion& c) { c.status = FrameStatus::kError; };
  for (int i = 0; i < 3; ++i) EXPECT_EQ(next(damage).status, FrameStatus::kError);
  EXPECT_EQ(source->queued(), 5U) << "a camera that is being unplugged gets nothing more to fail";
  EXPECT_EQ(next().status, FrameStatus::kSuccess);
  EXPECT_EQ(source->queued(), 8U);
}

TEST_F(RequestCameraTest, nothing_but_damaged_frames_ends_in_a_restart) {
  make();
  settle();
  for (int i = 0; i < 8; ++i) next([](Completion& c) { c.status = FrameStatus::kError; });
  EXPECT_EQ(source->queued(), 0U);
  source->on_start = [](FakeRequestSource& s) { s.on_queue = [](FakeRequestSource& now) { now.deliver(); }; };
  EXPECT_TRUE(camera->next_frame().has_value());
  EXPECT_EQ(camera->counts().restarts, 1U);
}

TEST_F(RequestCameraTest, a_buffer_completed_twice_is_lent_once) {
  make();
  settle();
  Completion done;
  const CameraFrame once = next([&](Completion& c) { done = c; });
  source->complete_again(done);
  const auto again = camera->next_frame();
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->status, FrameStatus::kError);
  EXPECT_TRUE(again->pixels.bytes().empty());
  EXPECT_EQ(source->queued(), 7U);
}

TEST_F(RequestCameraTest, changed_exposure_is_used_after_the_sensors_delay) {
  make();
  settle();
  CameraControls longer;
  longer.exposure_us = 3900;
  camera->change(longer);
  int unusable = 0;
  CameraFrame frame = next();
  for (; frame.status == FrameStatus::kStartup && unusable < 50; ++unusable) frame = next();
  ASSERT_EQ(source->changes.size(), 1U) << "with one request, not with each";
  EXPECT_EQ(source->changes[0].exposure_us, 3900U);
  EXPECT_EQ(unusable, 8 + 2) << "those queued before it, and the delay";
  EXPECT_EQ(frame.exposure_us, 3900U);
  EXPECT_EQ(camera->mode().exposure_us, 3900U);
}

TEST_F(RequestCameraTest, refusals_of_the_driver_are_errors) {
  make();
  camera->stop();
  source->refuse_start = true;
  EXPECT_FALSE(camera->start().has_value());
  source->refuse_start = false;
  source->refuse_queue = true;
  EXPECT_FALSE(camera->start().has_value());
  RequestCameraConfig wrong = quick();
  wrong.controls.exposure_us = 5000;
  const auto refused = RequestCamera::create(source, clock, wrong);
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().detail, testing::HasSubstr("exposure 5000 us in a frame of 4004 us"));
}

TEST(StampClock, takes_the_clock_that_the_driver_took) {
  constexpr Nanoseconds kNight{8LL * 3600 * 1'000'000'000};
  const DeviceTime now = device_time(50'000'000'000), taken = device_time(49'990'000'000);
  EXPECT_EQ(monotonic_stamp(to_ns(taken), now, kNight), taken);
  EXPECT_EQ(monotonic_stamp(to_ns(taken) + kNight.count(), now, kNight), taken);
  EXPECT_EQ(monotonic_stamp(to_ns(taken), now, Nanoseconds{0}), taken);
}

}  // namespace
}  // namespace enamel::fw::test
