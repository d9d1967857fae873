// The projector's waveform, and what three frames show of it.
#include "pipeline/decode/phase/waveform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>

#include "pipeline/decode/phase/waveform_fit.hpp"
#include "tests/unit/decode/phase/gamma_wave.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kPi = std::numbers::pi;
const Waveform kAny{{0.31, -0.12, 0.07, -0.05}};

TEST(Waveform, is_a_sum_of_cosines_of_multiples) {
  const WaveValues beyond(kAny);
  for (int i = 0; i < 1000; ++i) {
    const double phi = 2 * kPi * i / 1000, c = std::cos(phi), truth = test::wave_at(kAny, phi);
    EXPECT_NEAR(kAny.at(c).value, truth, 1e-12) << phi;
    EXPECT_NEAR(beyond.at(static_cast<float>(c)), truth - c, 1e-6) << phi;
  }
}

TEST(Waveform, slope_is_that_of_differences) {
  constexpr double kApart = 1e-5;
  for (int i = -999; i < 1000; ++i) {
    const double c = i / 1000.0;
    const double slope = (kAny.at(c + kApart).value - kAny.at(c - kApart).value) / (2 * kApart);
    EXPECT_NEAR(kAny.at(c).slope, slope, 1e-8) << c;
  }
}

TEST(Waveform, is_as_strong_as_its_second_harmonic_or_half_of_another) {
  EXPECT_EQ(kAny.strength(), 0.31);
  EXPECT_EQ((Waveform{{0.1, -0.3, 0, 0}}).strength(), 0.15);
  EXPECT_EQ((Waveform{{-0.2, 0.3, 0, 0}}).strength(), 0.2);
  EXPECT_EQ(Waveform{}.strength(), 0);
}

/// (g-1)/(g+2) and (g-1)(g-2)/((g+2)(g+3)): Liu et al. 2010.
TEST(Waveform, harmonics_of_a_gamma_are_the_textbooks) {
  for (const double g : {1.0, 1.5, 1.8, 2.5}) {
    const Waveform wave = test::gamma_wave(g);
    EXPECT_NEAR(wave.harmonic[0], (g - 1) / (g + 2), 1e-7) << g;
    EXPECT_NEAR(wave.harmonic[1], (g - 1) * (g - 2) / ((g + 2) * (g + 3)), 1e-7) << g;
  }
}

TEST(SeenWave, of_a_cosine_is_the_unit_circle) {
  for (const FrameScheme* frames : {&micro_three_step(), &four_step_three(), &four_step_four()}) {
    const SeenWave seen = see({}, *frames, 360);
    for (std::size_t i = 0; i < 360; ++i) {
      const double phi = kPi * static_cast<double>(i) / 180;
      EXPECT_NEAR(seen.mean[i], 0, 1e-9);
      EXPECT_NEAR(seen.cosine[i], std::cos(phi), 1e-9);
      EXPECT_NEAR(seen.sine[i], std::sin(phi), 1e-9);
    }
  }
}

TEST(SeenWave, is_what_three_frames_say_by_the_textbook) {
  for (const bool thirds : {true, false}) {
    const SeenWave seen = see(kAny, thirds ? micro_three_step() : four_step_three(), 360);
    for (std::size_t i = 0; i < 360; ++i) {
      const auto truth = test::three_frames_say(kAny, thirds, kPi * static_cast<double>(i) / 180);
      EXPECT_NEAR(seen.cosine[i], truth.real(), 1e-9) << thirds << ' ' << i;
      EXPECT_NEAR(seen.sine[i], truth.imag(), 1e-9) << thirds << ' ' << i;
    }
  }
}

TEST(SeenWave, even_harmonics_leave_the_phase_of_four_steps) {
  const SeenWave seen = see({{0.3, 0, 0.05, 0}}, four_step_four(), 360);
  for (std::size_t i = 0; i < 360; ++i) {
    const double phi = kPi * static_cast<double>(i) / 180;
    EXPECT_NEAR(test::turned(std::atan2(seen.sine[i], seen.cosine[i]) - phi), 0, 1e-9);
  }
}

/// Mode M's three frames and mode T's.
class FindWaveform : public testing::TestWithParam<bool> {
 protected:
  static constexpr int kFringe_px = 26;  ///< at mid-range; surfaces show others

  static const FrameScheme& frames() { return GetParam() ? micro_three_step() : four_step_three(); }
  static Waveform found(const test::FringesOnTexture& scene) {
    const WavePrior any{{}, WaveFitConfig{}.prior, WaveFitConfig{}.least_strength};
    return find_waveform(scene.solved(GetParam()), frames(), kFringe_px, {}, {&any, 1}).wave;
  }
};

INSTANTIATE_TEST_SUITE_P(Modes, FindWaveform, testing::Bool(), [](const auto& mode) { return mode.param ? "M" : "T"; });

TEST_P(FindWaveform, harmonics_of_a_gamma_are_found_on_texture_in_noise) {
  for (const double gamma : {1.5, 1.8, 2.5}) {
    const Waveform truth = test::gamma_wave(gamma);
    test::FringesOnTexture scene;
    scene.gamma = gamma;
    const Waveform wave = found(scene);
    EXPECT_NEAR(wave.harmonic[0], truth.harmonic[0], 0.01) << gamma;
    EXPECT_NEAR(wave.harmonic[1], truth.harmonic[1], 0.015) << gamma;
  }
}

TEST_P(FindWaveform, linear_projector_has_no_harmonics) { EXPECT_EQ(found({}).strength(), 0) << "negative control"; }

TEST_P(FindWaveform, motion_is_not_taken_for_a_wave) {
  for (const double motion : {-0.2, -0.1, 0.1, 0.2}) {
    test::FringesOnTexture scene;
    scene.motion_rad = motion;
    EXPECT_EQ(found(scene).strength(), 0) << motion;
  }
}

TEST_P(FindWaveform, few_pixels_tell_nothing) {
  test::FringesOnTexture scene;
  scene.gamma = 2.5;
  scene.height = 12;  // three rows are asked: 3 x 615 windows
  const WaveMoments moments = wave_moments(scene.solved(GetParam()), frames(), kFringe_px, 4);
  EXPECT_GT(moments.pixels, 1000);
  EXPECT_LT(moments.pixels, WaveFitConfig{}.min_pixels);
  EXPECT_EQ(found(scene).strength(), 0);
  scene.height = 16;
  EXPECT_GT(found(scene).strength(), 0.3) << "negative control: one row more";
}

TEST_P(FindWaveform, image_narrower_than_a_fringe_tells_nothing) {
  test::FringesOnTexture scene;
  scene.gamma = 2.5;
  scene.width = 20, scene.height = 800;
  EXPECT_EQ(wave_moments(scene.solved(GetParam()), frames(), kFringe_px, 4).pixels, 0);
  EXPECT_EQ(found(scene).strength(), 0);
}

}  // namespace
}  // namespace enamel::pipeline
