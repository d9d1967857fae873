// A board's profile, its sensors' files and its lines, each for what it refuses.
#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "firmware/device/linux/board/board_profile.hpp"
#include "firmware/device/linux/lines/gpio_chip.hpp"

namespace enamel::fw::test {
namespace {

using testing::HasSubstr;

std::string profile_of(const std::string& text) {
  const std::string path = testing::TempDir() + "/profile.toml";
  std::ofstream(path) << text;
  return path;
}

TEST(BoardProfile, is_refused_for_what_cannot_work) {
  const std::string rig = "[probe]\nrig = \"rig.json\"\n[sensors]\nled_current = \"/sys/ma\"\n";
  const auto good = read_profile(profile_of(rig + "[camera]\nid = \"ov9281\"\n[lines]\nstrobe = 5\n"));
  ASSERT_TRUE(good.has_value()) << good.error().message();
  EXPECT_EQ(good->camera, "ov9281");
  EXPECT_EQ(good->lines.strobe, 5U);
  EXPECT_EQ(good->rig, std::filesystem::path(testing::TempDir()) / "rig.json");
  EXPECT_EQ(good->camera_config().controls.frame_period, Nanoseconds{4'004'000});
  const auto why = [](const std::string& text) {
    const auto profile = read_profile(profile_of(text));
    return profile ? std::string("accepted") : profile.error().detail;
  };
  EXPECT_THAT(why(rig + "[camera]\nexposure_us = 3600\n"), HasSubstr("the exposure ends after 3600 us"));
  EXPECT_EQ(read_profile(profile_of(rig + "[camera]\nexposure_us = 3600\n")).error().code, ErrorCode::kBoardTiming);
  EXPECT_THAT(why(rig + "[lines]\nstrobe = 23\n"), HasSubstr("another use"));
  EXPECT_THAT(why(rig + "[projector]\nled_code = 500\n"), HasSubstr("max_led_code"));
  EXPECT_THAT(why(rig + "[projector]\ndmd = \"DLP4500\"\n"), HasSubstr("DLP2010 or DLP3010"));
  EXPECT_THAT(why(rig + "[camera]\nfocus = 1\n"), HasSubstr("focus"));
  EXPECT_THAT(why("[sensors]\nled_current = \"/sys/ma\"\n"), HasSubstr("probe.rig"));
  EXPECT_THAT(why(rig + "[heater]\npwm = \"/sys/class/pwm/pwmchip0/pwm0\"\n"), HasSubstr("sensors.tip"));
  EXPECT_THAT(why("[probe]\nrig = \"rig.json\"\n"), HasSubstr("whether the light is off"));
}

TEST(Sensors, that_are_open_or_shorted_have_no_value) {
  const auto file = [](const char* name, const std::string& text) {
    const std::string path = testing::TempDir() + "/" + name;
    std::ofstream(path) << text;
    return path;
  };
  const SysfsThermal thermal({.tip = file("tip", "36512\n"),
                              .led = file("led", "-273150\n"),
                              .soc = "/nowhere/temp",
                              .optics = file("optics", "words\n")});
  const Temperatures t = thermal.read();
  EXPECT_EQ(t.tip_cc, std::int16_t{3651});
  EXPECT_FALSE(t.led_cc.has_value());
  EXPECT_FALSE(t.soc_cc.has_value());
  EXPECT_FALSE(t.optics_cc.has_value());
}

TEST(GpioLines, that_are_not_there_are_told_with_the_remedy) {
  const std::array<std::uint32_t, 1> line{3};
  const auto none = request_lines("/dev/gpiochip-nosuch", line, LineUse::kEvents);
  ASSERT_FALSE(none.has_value());
  EXPECT_THAT(none.error().detail, HasSubstr("gpiodetect"));
  EXPECT_FALSE(request_lines("/dev/null", line, LineUse::kOutput).has_value());
  EXPECT_FALSE(set_line(LineHandle(), true));
}

}  // namespace
}  // namespace enamel::fw::test
