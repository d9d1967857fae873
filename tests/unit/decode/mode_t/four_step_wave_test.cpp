// Mode T behind a projector whose response is not linear.
#include "pipeline/decode/mode_t/four_step_wave.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/decoded_scene.hpp"
#include "tests/unit/decode/mode_m/micro_scene.hpp"
#include "tests/unit/decode/phase/gamma_wave.hpp"

namespace enamel::pipeline {
namespace {

using test::DecodedScene;
using test::Depth;
using test::figures;

const calib::Rig& rig() {
  static const calib::Rig kRig = test::cropped_rig(400, 120);
  return kRig;
}

const BurstDecoder& decoder() {
  static const BurstDecoder kDecoder = BurstDecoder::make(rig()).value();
  return kDecoder;
}

DecodedScene decode(const Depth& depth, double harmonic, double motion_rad, const BurstDecoder& by = decoder()) {
  test::SceneOptions o = test::noisy();
  o.harmonic = harmonic;
  o.motion_rad = motion_rad;
  return test::decode_scene(by, rig(), depth, o);
}

/// What a strong harmonic may cost.
struct Allowed {
  double rms_ratio = 1.25;  ///< over that of a linear projector
  double scatter_to_sigma = 1.2;
  double harmonic = 0.01;
};

void expect_as_good_as_linear(const Depth& depth, double harmonic, double motion_rad, const Allowed& allowed) {
  const DecodedScene linear = decode(depth, 0, motion_rad), r = decode(depth, harmonic, motion_rad);
  ASSERT_TRUE(linear.burst.accepted()) << figures(linear.burst);
  ASSERT_TRUE(r.burst.accepted()) << harmonic << ' ' << motion_rad << ' ' << figures(r.burst);
  EXPECT_GE(r.coverage(), 0.99) << harmonic << ' ' << motion_rad;
  EXPECT_EQ(r.wrong, 0U) << harmonic << ' ' << motion_rad;
  EXPECT_LE(r.rms_um(), allowed.rms_ratio * linear.rms_um()) << harmonic << ' ' << motion_rad;
  EXPECT_NEAR(r.burst.diagnostics.wave.harmonic[0], harmonic, allowed.harmonic) << motion_rad;
  EXPECT_GT(r.scatter_to_sigma(), 0.85) << harmonic << ' ' << motion_rad;
  EXPECT_LT(r.scatter_to_sigma(), allowed.scatter_to_sigma) << harmonic << ' ' << motion_rad;
}

TEST(FourStepWave, second_harmonic_leaves_the_noise_of_a_linear_projector) {
  expect_as_good_as_linear(test::flat(48), 0.15, 0, {});
  expect_as_good_as_linear(test::kSlant, 0.15, 0, {});
}

TEST(FourStepWave, strong_second_harmonic_leaves_it_too) {
  expect_as_good_as_linear(test::flat(48), 0.25, 0, {});
  expect_as_good_as_linear(test::kSlant, 0.25, 0, {});
}

TEST(FourStepWave, second_harmonic_in_motion_leaves_the_same) {
  for (const double motion : {-0.1, 0.1}) {
    expect_as_good_as_linear(test::flat(48), 0.15, motion, {});
    expect_as_good_as_linear(test::kSlant, 0.15, motion, {});
  }
}

/// Orders are right, and depth is half as far off again: motion looks a little like h_3, which is not found anew.
TEST(FourStepWave, strong_second_harmonic_in_motion_leaves_right_orders) {
  for (const double motion : {-0.1, 0.1}) {
    expect_as_good_as_linear(test::flat(48), 0.25, motion, {1.6, 1.3, 0.015});
    expect_as_good_as_linear(test::kSlant, 0.25, motion, {1.6, 1.3, 0.015});
  }
}

TEST(FourStepWave, wave_that_is_never_undone_leaves_no_right_depth) {
  DecodeConfig config;
  config.wave.least_strength = 1;
  const BurstDecoder never = BurstDecoder::make(rig(), config).value();
  for (const double motion : {0.0, 0.1}) {
    for (const Depth& depth : {test::flat(48), test::kSlant}) {
      const DecodedScene r = decode(depth, 0.25, motion, never);
      EXPECT_LT(r.coverage(), 0.1) << "negative control " << motion << ' ' << figures(r.burst);
      EXPECT_EQ(r.burst.diagnostics.wave.strength(), 0);
    }
  }
}

/// A fringe of a unit wave over a row, frame 3 at phi + 3 pi/2 or, where its sign is turned, at phi + pi/2.
PhaseMaps fringe_of(const Waveform& wave, int width, bool plus) {
  PhaseMaps maps;
  maps.resize(width, 1);
  for (int u = 0; u < width; ++u) {
    const double phi = 2 * std::numbers::pi * (u + 0.5) / width, quarter = std::numbers::pi / 2;
    const auto said = test::three_frames_say(wave, false, phi);
    const double mean = (test::wave_at(wave, phi) + test::wave_at(wave, phi + 2 * quarter)) / 2;
    const auto i = static_cast<std::size_t>(u);
    test::put_unit_wave(i, said, mean, test::wave_at(wave, phi + (plus ? 3 : 1) * quarter), maps);
    maps.sigma_rad[i] = 0.02F;
  }
  return maps;
}

TEST(LineariseFourStep, leaves_the_frames_of_a_cosine_whatever_the_sign_of_the_last) {
  const Waveform wave = test::gamma_wave(1.5);
  constexpr int kWidth = 500;
  for (const bool plus : {false, true}) {
    PhaseMaps maps = fringe_of(wave, kWidth, plus);
    linearise_four_step(wave, {}, maps);
    for (int u = 0; u < kWidth; ++u) {
      const double phi = 2 * std::numbers::pi * (u + 0.5) / kWidth;
      const auto i = static_cast<std::size_t>(u);
      ASSERT_EQ(maps.reject[i], PixelReject::kNone) << plus << ' ' << u;
      EXPECT_NEAR(test::turned(static_cast<double>(maps.phase_rad[i]) - phi), 0, 2e-3) << plus << ' ' << u;
      EXPECT_NEAR(maps.modulation_dn[i], 50, 0.1) << plus << ' ' << u;
      EXPECT_NEAR(maps.mean_dn[i], 100, 0.1) << plus << ' ' << u;
      // Frames 1 and 3 are alike there, and which one of them frame 3 is only the third harmonic would tell.
      const double unsure_dn = plus ? 100 * std::abs(wave.harmonic[1] * std::sin(3 * phi)) : 0;
      EXPECT_NEAR(maps.code_dn[i], (plus ? 50 : -50) * std::sin(phi),
                  0.2 + (std::abs(std::sin(phi)) < 0.3 ? unsure_dn : 0))
          << plus << ' ' << u;
    }
  }
}

int noisy_of(PhaseMaps maps, bool has_fourth) {
  if (!has_fourth) std::ranges::fill(maps.code_dn.pixels(), std::numeric_limits<float>::quiet_NaN());
  linearise_four_step(test::gamma_wave(1.8), {}, maps);
  return static_cast<int>(std::ranges::count(maps.reject.pixels(), PixelReject::kNoisy));
}

TEST(LineariseFourStep, counts_on_a_fourth_frame_that_will_join) {
  PhaseMaps maps = fringe_of(test::gamma_wave(1.8), 500, false);
  for (float& sigma_rad : maps.sigma_rad.pixels()) sigma_rad = 0.16F;
  EXPECT_LT(noisy_of(maps, true), noisy_of(maps, false) - 25);
}

TEST(LineariseFourStep, leaves_saturated_and_dark_pixels_and_decides_anew_which_are_noisy) {
  const Waveform wave = test::gamma_wave(1.8);
  PhaseMaps maps = fringe_of(wave, 500, false);
  for (float& sigma_rad : maps.sigma_rad.pixels()) sigma_rad = 0.1F;
  std::ranges::fill(maps.code_dn.pixels(), std::numeric_limits<float>::quiet_NaN());  // three frames are all there is
  maps.reject[0] = PixelReject::kSaturated, maps.reject[1] = PixelReject::kDark;
  const PhaseMaps before = maps;
  linearise_four_step(wave, {}, maps);
  int noisy = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(maps.reject[i], before.reject[i]);
    EXPECT_EQ(maps.phase_rad[i], before.phase_rad[i]);
  }
  for (std::size_t i = 2; i < maps.reject.size(); ++i) {
    EXPECT_EQ(maps.reject[i] == PixelReject::kNone, maps.sigma_rad[i] < 1.732F * PhaseConfig{}.max_sigma_rad) << i;
    noisy += maps.reject[i] == PixelReject::kNoisy ? 1 : 0;
  }
  EXPECT_GT(noisy, 25);   // phases that three frames hardly tell
  EXPECT_LT(noisy, 250);  // of 500
}

}  // namespace
}  // namespace enamel::pipeline
