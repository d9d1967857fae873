#include "firmware/acquire/acquisition.hpp"

#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <thread>

#include "tests/unit/firmware/device_run.hpp"

namespace enamel::fw::test {
namespace {

using proto::ReplyStatus;

/// The acquisition thread on a simulated device in virtual time.
class AcquisitionTest : public testing::Test {
 protected:
  void make(std::uint64_t bursts) {
    device = std::move(*SimDevice::create(std::make_unique<TaggedSource>(TaggedSource::Config{.count = bursts}), clock,
                                          DeviceRun::virtual_time()));
    light = std::make_unique<LightSwitch>(*device);
    light->permit(true);
    ledger.open(kSession);
    acquisition = std::make_unique<Acquisition>(device->hardware(), *light, ledger, [this](CapturedBurst b) {
      const std::lock_guard lock(mutex);
      captured.push_back(std::move(b));
      ledger.emit(kSession);
    });
  }
  AcquisitionReport wait() {
    for (;;) {
      const AcquisitionReport r = acquisition->report();
      if (r.phase != AcquisitionPhase::kRunning) return r;
      std::this_thread::yield();
    }
  }
  std::size_t count() {
    const std::lock_guard lock(mutex);
    return captured.size();
  }
  void expect_conservation() {
    const BurstCounts c = ledger.counts();
    EXPECT_EQ(c.under_way(), 0U);
    EXPECT_EQ(c.begun, c.emitted + c.dropped_total());
  }

  static constexpr ScanTag kSession{SessionId{7}, 1};
  VirtualClock clock;
  BurstLedger ledger;
  std::unique_ptr<SimDevice> device;
  std::unique_ptr<LightSwitch> light;
  std::mutex mutex;
  std::vector<CapturedBurst> captured;
  std::unique_ptr<Acquisition> acquisition;
};

TEST_F(AcquisitionTest, scan_delivers_every_burst_of_a_finite_source_and_ends) {
  make(50);
  acquisition->scan(kSession, std::nullopt);
  EXPECT_EQ(wait().phase, AcquisitionPhase::kEnded);
  ASSERT_EQ(count(), 50U);
  for (std::uint64_t i = 0; i < 50; ++i) EXPECT_EQ(captured[i].burst.burst_index, i);
  EXPECT_EQ(captured[0].temp_centi_c, 3225);
  EXPECT_EQ(ledger.counts().begun, 50U);
  expect_conservation();
  EXPECT_FALSE(device->enabled());
}

TEST_F(AcquisitionTest, limit_ends_the_scan_after_that_many_bursts) {
  make(50);
  acquisition->scan(kSession, 3);
  EXPECT_EQ(wait().phase, AcquisitionPhase::kDone);
  EXPECT_EQ(count(), 3U);
  EXPECT_EQ(ledger.counts().begun, 3U);
}

TEST_F(AcquisitionTest, without_strobes_nothing_is_measured_for_ever) {
  make(50);
  SimFaults faults;
  faults.on_step = [](SimStep& step) { step.edges.clear(); };
  device->set_faults(faults);
  acquisition->calibrate();
  EXPECT_EQ(wait().fault, ReplyStatus::kCamTimeout);
  EXPECT_FALSE(acquisition->stamp_delay().has_value());
}

/// From burst 10 on the stamps mean another instant; `tells`: the camera says that it was restarted.
SimFaults restarted_at_ten(bool tells) {
  SimFaults faults;
  faults.on_step = [tells, shifted = false](SimStep& step) mutable {
    if (step.burst_index == 10 && step.position == 1) {
      shifted = true;
      step.camera_restarted = tells;
    }
    if (!shifted) return;
    for (CameraFrame& f : step.frames) f.t_sensor += Nanoseconds{1'500'000};
  };
  return faults;
}

TEST_F(AcquisitionTest, after_a_restart_of_the_camera_its_stamps_are_measured_again) {
  make(50);
  device->set_faults(restarted_at_ten(true));
  acquisition->scan(kSession, std::nullopt);
  EXPECT_EQ(wait().phase, AcquisitionPhase::kEnded);
  EXPECT_EQ(count(), 49U) << "all but the one under way";
  EXPECT_EQ(ledger.counts().dropped[static_cast<std::size_t>(proto::DropReason::kSettling)], 1U);
  EXPECT_EQ(acquisition->stamp_delay()->median, Nanoseconds{1'520'000});
  expect_conservation();
}

/// Negative control: stamps that move without a word are not believed, and no burst comes whole.
TEST_F(AcquisitionTest, stamps_that_move_without_a_restart_cost_every_burst) {
  make(50);
  device->set_faults(restarted_at_ten(false));
  acquisition->scan(kSession, std::nullopt);
  EXPECT_EQ(wait().phase, AcquisitionPhase::kEnded);
  EXPECT_EQ(count(), 10U);
  expect_conservation();
}

TEST_F(AcquisitionTest, drain_loses_nothing) {
  make(100'000);
  acquisition->scan(kSession, std::nullopt);
  while (count() < 20) std::this_thread::yield();
  acquisition->drain();
  EXPECT_EQ(wait().phase, AcquisitionPhase::kDone);
  EXPECT_EQ(ledger.counts().dropped_total(), 0U);
  expect_conservation();
}

TEST_F(AcquisitionTest, abort_ends_at_once_and_counts_what_it_cut_off) {
  make(100'000);
  acquisition->scan(kSession, std::nullopt);
  while (count() < 20) std::this_thread::yield();
  acquisition->abort();
  EXPECT_NE(acquisition->report().phase, AcquisitionPhase::kRunning);
  EXPECT_LE(ledger.counts().dropped_total(), 1U);
  expect_conservation();
}

TEST_F(AcquisitionTest, scan_goes_on_after_a_pause) {
  make(40);
  acquisition->scan(kSession, 15);
  wait();
  acquisition->scan(kSession, std::nullopt);
  EXPECT_EQ(wait().phase, AcquisitionPhase::kEnded);
  EXPECT_EQ(count(), 40U);
  EXPECT_EQ(ledger.counts().begun, 40U);
}

TEST_F(AcquisitionTest, unplugged_camera_is_a_fault) {
  make(10);
  SimFaults faults;
  faults.camera_unplugged = true;
  device->set_faults(faults);
  acquisition->scan(kSession, std::nullopt);
  const AcquisitionReport r = wait();
  EXPECT_EQ(r.phase, AcquisitionPhase::kFailed);
  EXPECT_EQ(r.fault, ReplyStatus::kNoCamera);
}

TEST_F(AcquisitionTest, self_test_passes_on_a_sound_device) {
  make(1);
  acquisition->self_test();
  EXPECT_EQ(wait().phase, AcquisitionPhase::kDone);
  EXPECT_FALSE(device->enabled());
}

TEST_F(AcquisitionTest, self_test_finds_an_open_led) {
  make(1);
  SimFaults faults;
  faults.led_open = true;
  device->set_faults(faults);
  acquisition->self_test();
  EXPECT_EQ(wait().fault, ReplyStatus::kProjLedFault);
}

TEST_F(AcquisitionTest, self_test_finds_an_led_stuck_on) {
  make(1);
  SimFaults faults;
  faults.led_stuck_on = true;
  device->set_faults(faults);
  acquisition->self_test();
  const AcquisitionReport r = wait();
  EXPECT_EQ(r.fault, ReplyStatus::kLedStuck);
  EXPECT_TRUE(r.led_stuck);
}

TEST_F(AcquisitionTest, self_test_finds_an_open_thermistor) {
  make(1);
  SimFaults faults;
  faults.thermistor_open = true;
  device->set_faults(faults);
  acquisition->self_test();
  EXPECT_EQ(wait().fault, ReplyStatus::kThermistor);
}

TEST_F(AcquisitionTest, self_test_tells_what_the_projector_reports) {
  make(1);
  const std::array<std::pair<ProjectorStatus, ReplyStatus>, 3> reports{
      {{{.ready = false, .sequence_abort = true, .watchdog = true}, ReplyStatus::kProjNotReady},
       {{.ready = true, .sequence_abort = true, .watchdog = false}, ReplyStatus::kProjSeqAbort},
       {{.ready = true, .sequence_abort = false, .watchdog = true}, ReplyStatus::kProjWatchdog}}};
  for (const auto& [status, fault] : reports) {
    SimFaults faults;
    faults.projector = status;
    device->set_faults(faults);
    acquisition->self_test();
    EXPECT_EQ(wait().fault, fault);
  }
}

TEST_F(AcquisitionTest, led_that_fails_during_a_scan_is_a_fault) {
  make(100'000);
  acquisition->scan(kSession, std::nullopt);
  while (count() < 5) std::this_thread::yield();
  SimFaults faults;
  faults.led_open = true;
  device->set_faults(faults);
  EXPECT_EQ(wait().fault, ReplyStatus::kProjLedFault);
  expect_conservation();
}

TEST_F(AcquisitionTest, led_that_stays_on_during_a_scan_is_reported_as_stuck) {
  make(100'000);
  acquisition->scan(kSession, std::nullopt);
  while (count() < 5) std::this_thread::yield();
  SimFaults faults;
  faults.led_stuck_on = true;
  device->set_faults(faults);
  const AcquisitionReport r = wait();
  EXPECT_TRUE(r.led_stuck);
  expect_conservation();
}

TEST_F(AcquisitionTest, calibration_refuses_unsteady_stamps) {
  make(1);
  SimFaults faults;
  auto n = std::make_shared<int>(0);
  faults.on_step = [n](SimStep& s) { s.frames.front().t_sensor += Nanoseconds{(++*n % 5) * 150'000}; };
  device->set_faults(faults);
  acquisition->calibrate();
  EXPECT_EQ(wait().fault, ReplyStatus::kTsUnstable);
  device->set_faults({});
  acquisition->calibrate();
  EXPECT_EQ(wait().phase, AcquisitionPhase::kDone);
}

TEST(DelayCalibration, measures_the_stamps_delay_from_the_end_of_exposure) {
  DelayCalibration c(5);
  for (int i = 0; i < 5; ++i) {
    const std::int64_t t = 4'000'000 * i;
    c.on_strobe(device_time(t));
    EXPECT_FALSE(c.result().has_value());
    c.on_frame(device_time(t + 3'700'000 + 35'000 + 10 * i), 3700);
  }
  ASSERT_TRUE(c.result().has_value());
  EXPECT_EQ(c.result()->median.count(), 35'020);
  EXPECT_EQ(c.result()->mad.count(), 10);
}

TEST(LightSwitch, is_on_only_when_wanted_and_permitted) {
  class Lamp final : public Light {
   public:
    void set_enabled(bool on) noexcept override { on_ = on; }
    [[nodiscard]] bool enabled() const noexcept override { return on_; }
    [[nodiscard]] int sensed_ma() const noexcept override { return on_ ? 1 : 0; }

   private:
    bool on_ = true;
  } lamp;
  LightSwitch light(lamp);
  EXPECT_FALSE(lamp.enabled());
  light.want(true);
  EXPECT_FALSE(lamp.enabled());
  light.permit(true);
  EXPECT_TRUE(lamp.enabled());
  light.permit(false);
  EXPECT_FALSE(lamp.enabled());
  light.permit(true);
  light.want(false);
  EXPECT_FALSE(lamp.enabled());
}

}  // namespace
}  // namespace enamel::fw::test
