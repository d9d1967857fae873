// What the bursts before, and a calibration, tell of the projector's waveform, and what it is worth to the next burst.
#include "pipeline/decode/phase/wave_knowledge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "pipeline/decode/phase/waveform_fit.hpp"
#include "tests/unit/decode/phase/gamma_wave.hpp"

namespace enamel::pipeline {
namespace {

const WaveFitConfig kConfig;
const std::vector<WavePrior> kAny{{{}, kConfig.prior, kConfig.least_strength}};

WaveKnowledge shown(std::size_t bursts, const Waveform& wave) {
  WaveKnowledge known;
  for (std::size_t k = 0; k < bursts; ++k) learn(wave, known);
  return known;
}

calib::Rig rig_of_gamma(double gamma) {
  calib::Rig rig;
  rig.patterns.mode = calib::PatternMode::kMicro;
  rig.patterns.mean = 127.5, rig.patterns.amplitude = 127.5;
  calib::ProjectorResponse response;
  for (int level = 0; level <= 255; level += 3) {
    response.level.push_back(level);
    response.emission.push_back(std::pow(level / 255.0, gamma));
  }
  rig.response = response;
  return rig;
}

TEST(WaveKnowledge, a_few_strange_bursts_do_not_move_it) {
  WaveKnowledge known = shown(4, {{0.2, -0.05, 0.01, 0}});
  for (int k = 0; k < 3; ++k) learn({{-0.3, 0.2, 0.1, 0.1}}, known);
  EXPECT_EQ(known.median(), (Waveform{{0.2, -0.05, 0.01, 0}}));
  for (int k = 0; k < 2; ++k) learn({{-0.3, 0.2, 0.1, 0.1}}, known);
  EXPECT_EQ(known.median().harmonic[0], -0.3) << "negative control: most of them do";
}

TEST(WaveKnowledge, is_a_cosine_before_the_first_burst_and_half_way_between_two) {
  EXPECT_EQ(WaveKnowledge{}.median(), Waveform{});
  WaveKnowledge known = shown(1, {{0.1, 0, 0, 0}});
  learn({{0.2, 0, 0, 0}}, known);
  EXPECT_NEAR(known.median().harmonic[0], 0.15, 1e-12);
}

TEST(WaveKnowledge, once_complete_it_stays_as_it_is) {
  WaveKnowledge known = shown(kWavesLearned, {{0.1, 0, 0, 0}});
  EXPECT_TRUE(known.is_complete());
  const Waveform before = known.median();
  for (std::size_t k = 0; k < 3 * kWavesLearned; ++k) learn({{0.3, 0, 0, 0}}, known);
  EXPECT_EQ(known.median(), before);
}

TEST(PriorsAfter, more_bursts_say_more_but_never_all_of_the_next_one) {
  const Waveform wave{{0.2, -0.03, 0, 0}};
  EXPECT_EQ(priors_after({}, kAny, kConfig), kAny);
  double last = kConfig.prior[0];
  for (std::size_t bursts = 1; bursts <= kWavesLearned; ++bursts) {
    const auto priors = priors_after(shown(bursts, wave), kAny, kConfig);
    ASSERT_EQ(priors.size(), 1U);
    EXPECT_NEAR(priors.front().mean.harmonic[0], 0.2, 0.005);
    EXPECT_LT(priors.front().sigma[0], last);
    EXPECT_GT(priors.front().sigma[0], 0.99 * kConfig.defocus_share[0] * 0.2) << "defocus";
    EXPECT_EQ(priors.front().sigma[3], kConfig.prior[3]);
    last = priors.front().sigma[0];
  }
}

TEST(PriorsAfter, several_bursts_that_show_a_cosine_settle_it) {
  const Waveform weak{{0.02, -0.01, 0, 0}}, strong{{0.04, -0.01, 0, 0}};
  EXPECT_EQ(priors_after(shown(3, weak), kAny, kConfig).size(), 1U) << "negative control: too few";
  EXPECT_FALSE(is_settled(shown(3, weak), kConfig));
  EXPECT_TRUE(priors_after(shown(4, weak), kAny, kConfig).empty());
  EXPECT_TRUE(is_settled(shown(4, weak), kConfig));
  EXPECT_EQ(priors_after(shown(4, strong), kAny, kConfig).size(), 1U);
  EXPECT_FALSE(is_settled(shown(4, strong), kConfig));
  EXPECT_TRUE(is_settled(shown(kWavesLearned, strong), kConfig));
}

TEST(UncorrectedWave, of_a_gamma_is_the_textbooks) {
  for (const double gamma : {1.0, 1.5, 2.5}) {
    const calib::Rig rig = rig_of_gamma(gamma);
    const Waveform wave = uncorrected_wave(*rig.response, rig.patterns), truth = test::gamma_wave(gamma);
    for (std::size_t n = 0; n < kWaveHarmonics; ++n) EXPECT_NEAR(wave.harmonic[n], truth.harmonic[n], 1e-3) << gamma;
  }
}

TEST(PriorsOf, a_stated_response_is_a_second_possibility) {
  calib::Rig rig = rig_of_gamma(2.5);
  const auto priors = priors_of(rig, kConfig);
  ASSERT_EQ(priors.size(), 2U);
  EXPECT_EQ(priors.front(), kAny.front());
  const double sharp = test::gamma_wave(2.5).harmonic[0];
  EXPECT_LT(priors[1].mean.harmonic[0], sharp);
  EXPECT_GT(priors[1].mean.harmonic[0] + 1.1 * priors[1].sigma[0], sharp) << "no blur at all is within";
  rig.response.reset();
  EXPECT_EQ(priors_of(rig, kConfig), kAny);
}

/// Mode M's three frames and mode T's.
class KnownWave : public testing::TestWithParam<bool> {
 protected:
  static FoundWave found(const test::FringesOnTexture& scene, const std::vector<WavePrior>& priors) {
    const FrameScheme& frames = GetParam() ? micro_three_step() : four_step_three();
    return find_waveform(scene.solved(GetParam()), frames, 26, kConfig, priors);
  }
};

INSTANTIATE_TEST_SUITE_P(Modes, KnownWave, testing::Bool(), [](const auto& mode) { return mode.param ? "M" : "T"; });

TEST_P(KnownWave, is_believed_where_too_few_pixels_tell) {
  test::FringesOnTexture scene;
  scene.gamma = 2.5, scene.height = 12;
  const Waveform truth = test::gamma_wave(2.5);
  const FoundWave alone = found(scene, kAny), taught = found(scene, priors_after(shown(12, truth), kAny, kConfig));
  EXPECT_TRUE(alone.wave.is_cosine()) << "negative control";
  EXPECT_FALSE(taught.shown);
  EXPECT_NEAR(taught.wave.harmonic[0], truth.harmonic[0], 0.01);
}

TEST_P(KnownWave, weak_one_is_undone_once_several_bursts_have_shown_it) {
  test::FringesOnTexture scene;
  scene.gamma = 1.15;  // h_2 of 0.048
  const Waveform truth = test::gamma_wave(scene.gamma);
  const FoundWave alone = found(scene, kAny);
  EXPECT_TRUE(alone.wave.is_cosine()) << "negative control: motion looks like as much";
  ASSERT_TRUE(alone.shown);
  EXPECT_NEAR(alone.shown->harmonic[0], truth.harmonic[0], 0.015);
  const FoundWave taught = found(scene, priors_after(shown(6, *alone.shown), kAny, kConfig));
  EXPECT_NEAR(taught.wave.harmonic[0], truth.harmonic[0], 0.012);
}

TEST_P(KnownWave, burst_outvotes_what_does_not_hold_for_it) {
  test::FringesOnTexture scene;
  scene.gamma = 1.8;
  const auto priors = priors_after(shown(12, {{0.3, 0, 0, 0}}), kAny, kConfig);
  EXPECT_LT(found(scene, priors).wave.harmonic[0], 0.26) << "0.21 is true";
  EXPECT_NEAR(found(scene, priors).shown->harmonic[0], test::gamma_wave(1.8).harmonic[0], 0.01)
      << "what is learned from it is not what is known already";
}

TEST_P(KnownWave, cosine_that_is_settled_is_not_asked) {
  test::FringesOnTexture scene;
  scene.gamma = 2.5;
  const FoundWave wave = found(scene, {});
  EXPECT_TRUE(wave.wave.is_cosine());
  EXPECT_FALSE(wave.shown);
}

TEST_P(KnownWave, stated_response_serves_patterns_that_go_through_its_inverse_and_others) {
  const auto priors = priors_of(rig_of_gamma(2.2), kConfig);
  for (const double gamma : {1.0, 2.2}) {
    test::FringesOnTexture scene;
    scene.gamma = gamma;
    const Waveform truth = test::gamma_wave(gamma);
    EXPECT_NEAR(found(scene, priors).wave.harmonic[0], truth.harmonic[0], 0.012) << gamma;
    EXPECT_NEAR(found(scene, priors).wave.harmonic[2], truth.harmonic[2], 0.004) << gamma;
  }
}

}  // namespace
}  // namespace enamel::pipeline
