#include "host/motion/twin_axes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::motion {
namespace {

constexpr Nanoseconds kLong = std::chrono::minutes(5);
constexpr double kRad = std::numbers::pi / 180.0;

double bend(double deg, const TwinAxisConfig& c) {
  return deg + c.harmonic_deg[0] * (std::cos(deg * kRad) - 1.0) + c.harmonic_deg[1] * std::sin(deg * kRad);
}

/// Largest deviation of the true rotation from commanded angle with harmonic, over drawn moves.
double worst_play_deg(TwinAxesConfig config, std::uint64_t seed) {
  Rng rng(seed, 0, 0);
  draw_errors(config, rng);
  config.rot.backlash_deg = 0.05;
  TwinAxes axes(config);
  EXPECT_TRUE(axes.home(kLong));
  double worst = 0.0;
  for (int i = 0; i < 100; ++i) {
    const AxesAngles target{rng.uniform(0, 360), rng.uniform(-30, 30)};
    const auto at = axes.move_to(target, kLong);
    EXPECT_TRUE(at);
    worst = std::max(worst, std::abs(axes.true_angles().rot_deg - bend(target.rot_deg, config.rot)));
  }
  return worst;
}

TEST(TwinAxes, approach_from_below_leaves_the_harmonic_alone) {
  const double half_step = 0.5 / 800.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_LT(worst_play_deg({}, seed), half_step * 1.01);
    TwinAxesConfig naive;
    naive.overshoot_deg = 0.0;
    EXPECT_GT(worst_play_deg(naive, seed), 0.045) << "negative control: without the rule the play shows";
  }
}

TEST(TwinAxes, harmonic_has_the_amplitude_it_claims) {
  Rng rng(5, 0, 0);
  TwinAxesConfig config;
  draw_errors(config, rng);
  EXPECT_NEAR(std::hypot(config.rot.harmonic_deg[0], config.rot.harmonic_deg[1]), 0.02, 1e-12);
  EXPECT_NE(config.rot.harmonic_deg[0], config.swing.harmonic_deg[0]);
}

TEST(TwinAxes, a_lost_step_is_seen_by_an_encoder_only) {
  for (const bool has_encoder : {false, true}) {
    TwinAxesConfig config;
    config.has_encoder = has_encoder;
    TwinAxes axes(config);
    ASSERT_TRUE(axes.home(kLong));
    axes.lose_rot_step();
    const auto at = axes.move_to({90.0, 0.0}, kLong);
    EXPECT_EQ(at.has_value(), !has_encoder);
    EXPECT_NEAR(axes.true_angles().rot_deg, 90.0 - 1.8, 0.001);
    EXPECT_EQ(axes.state(), has_encoder ? AxesState::kUnhomed : AxesState::kReady);
    if (!at) {
      EXPECT_EQ(at.error().code, ErrorCode::kAxesStep);
      EXPECT_NE(at.error().detail.find("steps were lost"), std::string::npos);
    }
    ASSERT_TRUE(axes.home(kLong));
    ASSERT_TRUE(axes.move_to({90.0, 0.0}, kLong));
    EXPECT_NEAR(axes.true_angles().rot_deg, 90.0, 0.001) << "homing finds it again";
  }
}

TEST(TwinAxes, read_back_is_the_table_or_nothing) {
  TwinAxesConfig config;
  config.rot.harmonic_deg = {0.0, 0.02};
  TwinAxes blind(config);
  ASSERT_TRUE(blind.home(kLong));
  EXPECT_TRUE(std::isnan(blind.move_to({90.0, 0.0}, kLong)->read.rot_deg));
  config.has_encoder = true;
  TwinAxes seeing(config);
  ASSERT_TRUE(seeing.home(kLong));
  EXPECT_NEAR(seeing.move_to({90.0, 0.0}, kLong)->read.rot_deg, 90.02, 0.001);
}

TEST(TwinAxes, obeys_the_rules_of_axes) {
  TwinAxes axes({});
  EXPECT_EQ(axes.move_to({10.0, 0.0}, kLong).error().code, ErrorCode::kAxes) << "not homed";
  ASSERT_TRUE(axes.home(kLong));
  EXPECT_EQ(axes.move_to({400.0, 0.0}, kLong).error().code, ErrorCode::kAxesRange);
  EXPECT_FALSE(axes.move_to({150.0, 0.0}, std::chrono::seconds(5))) << "takes ten";
  EXPECT_NEAR(axes.true_angles().rot_deg, 74.5, 0.01)
      << "half way, and stands; the swing's overshoot took half a degree";
  axes.request_stop();
  EXPECT_EQ(axes.move_to({150.0, 0.0}, kLong).error().code, ErrorCode::kCancelled);
  ASSERT_TRUE(axes.move_to({150.0, 0.0}, kLong));
  EXPECT_NEAR(axes.true_angles().rot_deg, 150.0, 0.001);
}

}  // namespace
}  // namespace enamel::motion
