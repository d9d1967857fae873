// Mode M behind a projector whose response is not linear.
#include "pipeline/decode/mode_m/micro_wave.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/mode_m/micro_scene.hpp"
#include "tests/unit/decode/phase/gamma_wave.hpp"

namespace enamel::pipeline {
namespace {

using test::DecodedScene;
using test::Depth;
using test::figures;
using test::wide_rig;

DecodedScene decode(const Depth& depth, double harmonic, double motion_rad, const BurstDecoder& by = test::decoder()) {
  test::SceneOptions o = test::noisy();
  o.harmonic = harmonic;
  o.motion_rad = motion_rad;
  return test::decode_scene(by, wide_rig(), depth, o);
}

/// rms of the noise over that of a linear projector: that of three frames' phase, sqrt(<1/|dw/dphi|^2>), would be 1.14
/// at a harmonic of 0.25, and the code frame tells more.
constexpr double kLouder = 1.25;

void expect_as_good_as_linear(const Depth& depth, double motion_rad) {
  const DecodedScene linear = decode(depth, 0, motion_rad);
  ASSERT_TRUE(linear.burst.accepted()) << figures(linear.burst);
  for (const double harmonic : {0.15, 0.25}) {
    const DecodedScene r = decode(depth, harmonic, motion_rad);
    ASSERT_TRUE(r.burst.accepted()) << harmonic << ' ' << motion_rad << ' ' << figures(r.burst);
    EXPECT_GE(r.coverage(), 0.99) << harmonic << ' ' << motion_rad;
    EXPECT_EQ(r.wrong, 0U) << harmonic << ' ' << motion_rad;
    EXPECT_LE(r.rms_um(), kLouder * linear.rms_um()) << harmonic << ' ' << motion_rad;
    EXPECT_NEAR(r.burst.diagnostics.wave.harmonic[0], harmonic, 0.01) << motion_rad;
    EXPECT_NEAR(r.burst.diagnostics.motion_rad, motion_rad, 0.005) << harmonic;
    EXPECT_GT(r.scatter_to_sigma(), 0.85) << harmonic << ' ' << motion_rad;
    EXPECT_LT(r.scatter_to_sigma(), 1.2) << harmonic << ' ' << motion_rad;
  }
}

TEST(MicroWave, plane_behind_a_strong_second_harmonic_is_as_good_as_behind_none) {
  expect_as_good_as_linear(test::flat(48), 0);
}

TEST(MicroWave, slanted_surface_behind_a_strong_second_harmonic_is_as_good_as_behind_none) {
  expect_as_good_as_linear(test::kSlant, 0);
}

TEST(MicroWave, motion_and_a_strong_second_harmonic_are_told_apart) {
  for (const double motion : {-0.1, 0.1}) {
    expect_as_good_as_linear(test::flat(48), motion);
    expect_as_good_as_linear(test::kSlant, motion);
  }
}

TEST(MicroWave, wave_that_is_never_undone_leaves_no_depth_or_ripples) {
  DecodeConfig config;
  config.wave.least_strength = 1;
  const BurstDecoder never = BurstDecoder::make(wide_rig(), config).value();
  for (const double motion : {0.0, 0.1}) {
    for (const Depth& depth : {test::flat(48), test::kSlant}) {
      const DecodedScene r = decode(depth, 0.25, motion, never);
      const double undone_um = decode(depth, 0.25, motion).rms_um();
      EXPECT_TRUE(r.coverage() < 0.1 || r.rms_um() > 2 * undone_um)
          << "negative control " << motion << ' ' << r.rms_um() << " um, undone " << undone_um << ' '
          << figures(r.burst);
      EXPECT_EQ(r.burst.diagnostics.wave.strength(), 0);
    }
  }
}

/// A fringe of a unit wave over a row: what linearise_micro is given, without noise.
PhaseMaps fringe_of(const Waveform& wave, int width) {
  PhaseMaps maps;
  maps.resize(width, 1);
  for (int u = 0; u < width; ++u) {
    const double phi = 2 * std::numbers::pi * (u + 0.5) / width, third = 2 * std::numbers::pi / 3;
    const auto said = test::three_frames_say(wave, true, phi);
    const double mean =
        (test::wave_at(wave, phi) + test::wave_at(wave, phi + third) + test::wave_at(wave, phi - third)) / 3;
    const auto i = static_cast<std::size_t>(u);
    test::put_unit_wave(i, said, mean, test::wave_at(wave, 2 * phi), maps);
    maps.sigma_rad[i] = 0.05F;
  }
  return maps;
}

TEST(LineariseMicro, leaves_the_frames_of_a_cosine) {
  const Waveform wave = test::gamma_wave(1.5);
  constexpr int kWidth = 500;
  PhaseMaps maps = fringe_of(wave, kWidth);
  linearise_micro(wave, {}, maps);
  for (int u = 0; u < kWidth; ++u) {
    const double phi = 2 * std::numbers::pi * (u + 0.5) / kWidth;
    const auto i = static_cast<std::size_t>(u);
    ASSERT_EQ(maps.reject[i], PixelReject::kNone) << u;
    EXPECT_NEAR(test::turned(static_cast<double>(maps.phase_rad[i]) - phi), 0, 1e-3) << u;
    EXPECT_NEAR(maps.modulation_dn[i], 50, 0.05) << u;
    EXPECT_NEAR(maps.mean_dn[i], 100, 0.05) << u;
    EXPECT_NEAR(maps.cosine_dn[i], 50 * std::cos(phi), 0.1) << u;
    EXPECT_NEAR(maps.sine_dn[i], 50 * std::sin(phi), 0.1) << u;
    if (wave.at(std::cos(2 * phi)).slope < 0.3) continue;  // so flat that the level may say too little
    EXPECT_NEAR(maps.code_dn[i], 50 * std::cos(2 * phi), 0.2) << u;
  }
}

TEST(LineariseMicro, decides_anew_which_phases_are_noisy_and_leaves_saturated_and_dark_ones) {
  const Waveform wave = test::gamma_wave(2.2);
  constexpr int kWidth = 500;
  PhaseMaps maps = fringe_of(wave, kWidth);
  maps.reject[0] = PixelReject::kSaturated, maps.reject[1] = PixelReject::kDark;
  const PhaseMaps before = maps;
  linearise_micro(wave, {}, maps);
  EXPECT_EQ(maps.reject[0], PixelReject::kSaturated);
  EXPECT_EQ(maps.reject[1], PixelReject::kDark);
  EXPECT_EQ(maps.phase_rad[0], before.phase_rad[0]);
  EXPECT_EQ(maps.phase_rad[1], before.phase_rad[1]);
  int noisier = 0, calmer = 0;
  for (std::size_t i = 2; i < kWidth; ++i) {
    EXPECT_EQ(maps.reject[i] == PixelReject::kNone, maps.sigma_rad[i] < 1.732F * PhaseConfig{}.max_sigma_rad) << i;
    (maps.sigma_rad[i] > before.sigma_rad[i] ? noisier : calmer) += 1;
  }
  EXPECT_GT(noisier, 50);
  EXPECT_GT(calmer, 50);
}

TEST(LineariseMicro, keeps_what_is_lit_well_and_leaves_out_what_is_not_wherever_in_the_fringe) {
  const float most = PhaseConfig{}.max_sigma_rad;
  for (const float by_light : {0.9F * most, 1.1F * most}) {
    PhaseMaps maps = fringe_of(test::gamma_wave(1.6), 500);
    for (float& sigma_rad : maps.sigma_rad.pixels()) sigma_rad = by_light;
    linearise_micro(test::gamma_wave(1.6), {}, maps);
    int kept_beyond = 0, left_out_below = 0;
    for (std::size_t i = 0; i < maps.reject.size(); ++i) {
      const bool kept = maps.reject[i] == PixelReject::kNone;
      kept_beyond += kept && maps.sigma_rad[i] > most ? 1 : 0;
      left_out_below += !kept && maps.sigma_rad[i] < most ? 1 : 0;
    }
    EXPECT_EQ(kept_beyond > 50, by_light < most) << by_light;
    EXPECT_EQ(left_out_below > 50, by_light > most) << by_light;
  }
}

TEST(LineariseMicro, saturated_code_frame_stays_unknown) {
  const Waveform wave = test::gamma_wave(1.5);
  PhaseMaps maps = fringe_of(wave, 50);
  for (float& code_dn : maps.code_dn.pixels()) code_dn = std::numeric_limits<float>::quiet_NaN();
  linearise_micro(wave, {}, maps);
  for (const float code_dn : maps.code_dn.pixels()) EXPECT_TRUE(std::isnan(code_dn));
}

}  // namespace
}  // namespace enamel::pipeline
