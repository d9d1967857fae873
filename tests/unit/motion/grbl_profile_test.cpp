#include "host/motion/grbl_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/base/rng.hpp"

namespace enamel::motion {
namespace {

GrblSettings fitting() {
  return {{1, 255}, {10, 1}, {13, 0}, {20, 1}, {22, 1}, {32, 0}, {100, 800}, {101, 800}, {130, 400}, {131, 70}};
}

TEST(GrblProfile, the_shipped_file_says_what_the_program_takes_without_one) {
  const auto file = read_grbl_profile(std::string(ENAMEL_SOURCE_DIR) + "/config/desktop/grbl.toml");
  ASSERT_TRUE(file) << file.error().message();
  const GrblProfile own;
  for (const auto& [a, b] : {std::pair{&file->rot, &own.rot}, std::pair{&file->swing, &own.swing}}) {
    EXPECT_EQ(a->letter, b->letter);
    EXPECT_EQ(a->deg_per_unit, b->deg_per_unit);
    EXPECT_EQ(a->steps_per_deg, b->steps_per_deg);
    EXPECT_EQ(a->min_deg, b->min_deg);
    EXPECT_EQ(a->max_deg, b->max_deg);
    EXPECT_EQ(a->home_deg, b->home_deg);
  }
  EXPECT_EQ(file->feed_deg_per_s, own.feed_deg_per_s);
  EXPECT_EQ(file->overshoot_deg, own.overshoot_deg);
  EXPECT_EQ(file->settle_ms, own.settle_ms);
  EXPECT_EQ(file->banner_ms, own.banner_ms);
}

TEST(GrblProfile, contradictions_are_refused) {
  for (const char* text :
       {"[rotation]\nletter = \"A\"", "[swing]\nletter = \"X\"", "[rotation]\nmin_deg = 5\nmax_deg = 5",
        "[rotation]\nhome_deg = -2", "[rotation]\ndeg_per_unit = 0.0", "[rotation]\nsteps_per_deg = 0",
        "[rotation]\nsteps = 800", "[motion]\novershoot_deg = -1", "[rotation]\nletter = \"\"",
        "[swing]\nmin_deg = -30.2\nmax_deg = -29.8", "[motion]\nfeed_deg_per_s = nan"}) {
    EXPECT_FALSE(parse_grbl_profile(text, "profile")) << text;
  }
  EXPECT_TRUE(parse_grbl_profile("[rotation]\ndeg_per_unit = -0.5", "profile"));
}

TEST(GrblProfile, wrong_microsteps_are_refused_with_both_numbers) {
  GrblSettings settings = fitting();
  EXPECT_TRUE(check_settings(settings, {}));
  settings[100] = 1600;
  const auto checked = check_settings(settings, {});
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::kConfigValue);
  EXPECT_NE(checked.error().detail.find("$100 is 1600, expected 800"), std::string::npos) << checked.error().detail;
}

TEST(GrblProfile, every_setting_that_angles_depend_on_is_looked_at) {
  for (const auto& [number, bad] : GrblSettings{{1, 25}, {10, 0}, {13, 1}, {20, 0}, {22, 0}, {32, 1}, {101, 400}}) {
    GrblSettings settings = fitting();
    settings[number] = bad;
    EXPECT_FALSE(check_settings(settings, {})) << number;
    settings.erase(number);
    EXPECT_FALSE(check_settings(settings, {})) << number << " is not reported";
  }
}

TEST(GrblProfile, travel_beyond_the_soft_limits_is_refused) {
  GrblScale scale{.home_units = {-399.0, -69.0}, .home_deg = {0.0, -30.0}};
  EXPECT_TRUE(check_travel(fitting(), {}, scale));
  scale.home_units[0] = -1.0;  // homed to the other end
  EXPECT_FALSE(check_travel(fitting(), {}, scale));
}

TEST(GrblProfile, angles_and_units_are_inverse_for_any_scale) {
  Rng rng(3, 0, 0);
  for (int i = 0; i < 1000; ++i) {
    const GrblScale scale{.home_units = {rng.uniform(-500, 500), rng.uniform(-500, 500)},
                          .home_deg = {rng.uniform(-50, 50), rng.uniform(-50, 50)},
                          .deg_per_unit = {rng.uniform(0.1, 10), -rng.uniform(0.1, 10)}};
    const AxesAngles want{rng.uniform(-360, 360), rng.uniform(-60, 60)};
    const AxesAngles got = scale.angles(scale.units(want));
    EXPECT_NEAR(got.rot_deg, want.rot_deg, 1e-9);
    EXPECT_NEAR(got.swing_deg, want.swing_deg, 1e-9);
  }
}

TEST(GrblProfile, feed_keeps_the_speed_of_the_axis_that_goes_further) {
  GrblProfile profile;
  profile.rot.deg_per_unit = 2.0;
  // 30 degrees at 15 a second are two seconds; the way is hypot(15, 40 / 2) = 25 units where swing has one degree a
  // unit.
  EXPECT_NEAR(feed_units_per_min({0.0, 0.0}, {30.0, 20.0}, profile), 25.0 / 2.0 * 60.0, 1e-9);
  EXPECT_GE(feed_units_per_min({5.0, 5.0}, {5.0, 5.0}, profile), 1.0);
}

}  // namespace
}  // namespace enamel::motion
