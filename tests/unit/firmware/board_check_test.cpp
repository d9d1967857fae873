// --check on a simulated device in virtual time: what is good passes, each fault is named.
#include "firmware/check/board_check.hpp"

#include <gmock/gmock.h>

#include <thread>

#include "tests/unit/firmware/device_run.hpp"

namespace enamel::fw::test {
namespace {

using testing::HasSubstr;

class BoardCheck : public testing::Test {
 protected:
  CheckReport check(const SimFaults& faults = {}) {
    device = std::move(*SimDevice::create(std::make_unique<TaggedSource>(TaggedSource::Config{.count = 200}), clock,
                                          DeviceRun::virtual_time()));
    device->set_faults(faults);
    config.meanwhile = [](Nanoseconds) {
      std::this_thread::yield();
      return true;
    };
    config.least_mean_dn = 0;  // a tagged burst is no picture
    config.most_saturated = 1;
    return check_device(*device, clock, config);
  }
  VirtualClock clock;
  std::unique_ptr<SimDevice> device;
  CheckConfig config;
};

TEST_F(BoardCheck, a_sound_device_passes_with_its_figures) {
  const CheckReport report = check();
  ASSERT_TRUE(report.good()) << report.findings.back().part << ": " << report.findings.back().found;
  ASSERT_EQ(report.findings.size(), 5U);
  EXPECT_THAT(report.findings[0].found, HasSubstr("one every"));
  EXPECT_THAT(report.findings[1].found, HasSubstr("20.0 us behind"));
  EXPECT_THAT(report.findings[3].found, HasSubstr("20 of 20 whole"));
  EXPECT_TRUE(report.picture.has_value());
  EXPECT_FALSE(device->enabled());
}

TEST_F(BoardCheck, each_fault_is_named_and_the_light_is_off) {
  struct Case {
    const char* part;
    ErrorCode code;
    const char* says;
    SimFaults faults;
  };
  std::vector<Case> cases(5);
  cases[0] = {"frames", ErrorCode::kCamera, "disconnected", {}};
  cases[0].faults.camera_unplugged = true;
  cases[1] = {"light", ErrorCode::kProjector, "no current in the LED", {}};
  cases[1].faults.led_open = true;
  cases[2] = {"light", ErrorCode::kHal, "light where none should be", {}};
  cases[2].faults.led_stuck_on = true;
  cases[3] = {"light", ErrorCode::kBoardThermal, "sensors.tip", {}};
  cases[3].faults.thermistor_open = true;
  cases[4] = {"bursts", ErrorCode::kBoardTiming, "docs/probe.md", {}};
  cases[4].faults.trigger_missed = [](std::uint64_t burst, int position) { return burst == 3 && position == 2; };
  for (const Case& c : cases) {
    const CheckReport report = check(c.faults);
    ASSERT_FALSE(report.good()) << c.says;
    const CheckFinding& last = report.findings.back();
    EXPECT_EQ(last.part, c.part);
    EXPECT_EQ(last.fault, c.code) << c.says;
    EXPECT_THAT(last.found, HasSubstr(c.says));
    EXPECT_FALSE(device->enabled());
  }
}

TEST_F(BoardCheck, stamps_that_scatter_are_refused_with_their_scatter) {
  SimFaults faults;
  int n = 0;
  faults.on_step = [&n](SimStep& step) {
    // Most distances stay as they were: the rate looks right.
    for (CameraFrame& f : step.frames) f.t_sensor += Nanoseconds{(++n / 4 % 3) * 400'000};
  };
  const CheckReport report = check(faults);
  ASSERT_FALSE(report.good());
  EXPECT_EQ(report.findings.back().part, "stamps");
  EXPECT_EQ(report.findings.back().fault, ErrorCode::kBoardTiming);
  EXPECT_THAT(report.findings.back().found, HasSubstr("of at most 100"));
}

TEST_F(BoardCheck, a_sensor_with_a_rate_of_its_own_is_told_the_rate) {
  SimFaults faults;
  std::int64_t late = 0;
  faults.on_step = [&late](SimStep& step) {
    late += 40'000;  // one per cent slow
    for (CameraFrame& f : step.frames) f.t_sensor += Nanoseconds{late};
  };
  const CheckReport report = check(faults);
  ASSERT_FALSE(report.good());
  EXPECT_EQ(report.findings.back().part, "frames");
  EXPECT_THAT(report.findings.back().found, HasSubstr("keeps its own rate"));
}

TEST_F(BoardCheck, dark_and_glaring_pictures_are_told) {
  config.least_mean_dn = 0;
  check();
  const auto judge = [&](double least, double most) {
    device = std::move(*SimDevice::create(std::make_unique<TaggedSource>(TaggedSource::Config{.count = 200}), clock,
                                          DeviceRun::virtual_time()));
    config.least_mean_dn = least;
    config.most_saturated = most;
    return check_device(*device, clock, config).findings.back();
  };
  EXPECT_THAT(judge(300, 1).found, HasSubstr("too dark"));
  EXPECT_THAT(judge(0, -1).found, HasSubstr("too bright"));
}

TEST_F(BoardCheck, can_be_stopped) {
  check();
  config.meanwhile = [](Nanoseconds) { return false; };
  device = std::move(*SimDevice::create(std::make_unique<TaggedSource>(TaggedSource::Config{.count = 200}), clock,
                                        DeviceRun::virtual_time()));
  const CheckReport report = check_device(*device, clock, config);
  EXPECT_EQ(report.findings.back().fault, ErrorCode::kCancelled);
  EXPECT_FALSE(device->enabled());
}

TEST(CheckPictures, lie_side_by_side_in_either_depth) {
  CheckPicture p{2, 1, 8, {1, 2, 3, 4, 5, 6, 7, 8}};
  EXPECT_EQ(pgm_of(p), std::string("P5\n8 1\n255\n") + "\x01\x02\x03\x04\x05\x06\x07\x08");
  CheckPicture deep{1, 1, 10, {1, 2, 3, 0, 5, 0, 7, 0}};
  EXPECT_EQ(pgm_of(deep).substr(0, 16), "P5\n4 1\n1023\n\x02\x01" + std::string("\0\x03", 2));
}

}  // namespace
}  // namespace enamel::fw::test
