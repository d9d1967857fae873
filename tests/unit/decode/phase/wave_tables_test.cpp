// Tables that undo the projector's waveform.
#include "pipeline/decode/phase/wave_tables.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "tests/unit/decode/phase/gamma_wave.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kPhases = 7777;  ///< asked; no multiple of the tables' own

struct Undone {
  PhaseTable::Entry entry;
  double error_rad = 0, modulation = 0, mean = 0;  ///< of the phase; B and A as they come out, 1 and 0 in truth
};

/// A phase as three frames show it, and as the table brings it back.
Undone undo(const Waveform& wave, bool thirds, const PhaseTable& table, double phi) {
  const std::complex<double> said = test::three_frames_say(wave, thirds, phi);
  const double step = thirds ? 2 * kPi / 3 : kPi, shown = std::arg(said);
  const double first = test::wave_at(wave, phi), later = test::wave_at(wave, phi + step);
  const double mean = thirds ? (first + later + test::wave_at(wave, phi + 2 * step)) / 3 : (first + later) / 2;
  const PhaseTable::Entry e = table.at(static_cast<float>(shown));
  return {e, test::turned(shown + static_cast<double>(e.turn_rad) - phi), std::abs(said) * static_cast<double>(e.scale),
          mean + std::abs(said) * static_cast<double>(e.mean)};
}

double phase_of(int i) { return -kPi + 2 * kPi * (i + 0.5) / kPhases; }

TEST(PhaseTable, brings_the_phase_shown_back_to_the_true_one) {
  for (const auto& [gamma, thirds] : {std::pair(2.5, true), std::pair(1.8, true), std::pair(1.8, false)}) {
    const Waveform wave = test::gamma_wave(gamma);
    const PhaseTable table(wave, thirds ? micro_three_step() : four_step_three());
    for (int i = 0; i < kPhases; ++i) {
      const Undone at = undo(wave, thirds, table, phase_of(i));
      EXPECT_NEAR(at.error_rad, 0, 1e-3) << gamma << ' ' << thirds << ' ' << phase_of(i);
      EXPECT_NEAR(at.modulation, 1, 3e-3) << gamma << ' ' << thirds << ' ' << phase_of(i);
      EXPECT_NEAR(at.mean, 0, 3e-3) << gamma << ' ' << thirds << ' ' << phase_of(i);
    }
  }
}

TEST(PhaseTable, slope_is_that_of_the_true_phase_over_the_phase_shown) {
  const Waveform wave = test::gamma_wave(1.8);
  const PhaseTable table(wave, micro_three_step());
  constexpr double kApart_rad = 1e-3;
  for (int i = 0; i < kPhases; ++i) {
    const auto shown = [&](double phi) { return std::arg(test::three_frames_say(wave, true, phi)); };
    const double phi = phase_of(i), rise = test::turned(shown(phi + kApart_rad) - shown(phi - kApart_rad));
    EXPECT_NEAR(table.at(static_cast<float>(shown(phi))).slope, 2 * kApart_rad / rise, 0.02) << phi;
  }
}

TEST(PhaseTable, of_a_cosine_changes_nothing) {
  for (const FrameScheme* frames : {&micro_three_step(), &four_step_three()}) {
    const PhaseTable table({}, *frames);
    for (int i = 0; i < kPhases; ++i) {
      const PhaseTable::Entry e = table.at(static_cast<float>(phase_of(i)));
      EXPECT_NEAR(e.turn_rad, 0, 1e-5);
      EXPECT_NEAR(e.scale, 1, 1e-5);
      EXPECT_NEAR(e.mean, 0, 1e-5);
      EXPECT_NEAR(e.slope, 1, 1e-3);
      EXPECT_NEAR(e.spread_rad, 0, 1e-5);
    }
  }
}

struct Unsure {
  double most_slope = 0, most_spread_rad = 0;
  double normalised = 0, alike = 0;  ///< squares of errors over spread; phases with a spread
};

/// Of true phases evenly spread over an interval none lies further from its middle than 1.73 sigma; twice that at the
/// ends of the interval, where entries are linear between one phase and several.
Unsure expect_as_unsure_as_told(const Waveform& wave) {
  const PhaseTable table(wave, four_step_three());
  Unsure most;
  for (int i = 0; i < kPhases; ++i) {
    const Undone at = undo(wave, false, table, phase_of(i));
    const auto spread = static_cast<double>(at.entry.spread_rad), slope = static_cast<double>(at.entry.slope);
    EXPECT_LE(std::abs(at.error_rad), 4 * spread + 1e-3 * slope) << wave.harmonic[0] << ' ' << phase_of(i);
    if (std::abs(at.error_rad) > 1e-3) {
      EXPECT_TRUE(spread > 0 || slope > 1) << wave.harmonic[0] << ' ' << phase_of(i);
    }
    most.most_slope = std::max(most.most_slope, slope);
    most.most_spread_rad = std::max(most.most_spread_rad, spread);
    if (spread < 0.01) continue;
    most.normalised += std::pow(at.error_rad / spread, 2), most.alike += 1;
  }
  return most;
}

/// The phase shown hardly moves at some phases: by 0.09 rad a radian at 2.8.
TEST(PhaseTable, tells_how_unsure_it_is_of_a_strong_gamma) {
  for (const double gamma : {2.5, 2.65, 2.8}) {
    const Unsure most = expect_as_unsure_as_told(test::gamma_wave(gamma));
    EXPECT_NEAR(most.most_slope, 4, 1e-6) << gamma << ": the largest that is told";
    EXPECT_EQ(most.most_spread_rad, 0) << gamma << ": none looks exactly like another";
  }
}

/// Blur leaves less of the third harmonic, and the phase shown turns back on itself. The scatter over sigma is more
/// than 1 by the ends of the interval alone, where many true phases share few entries.
TEST(PhaseTable, tells_how_unsure_it_is_where_phases_look_alike) {
  for (const Waveform& wave : {Waveform{{0.36, 0, 0, 0}}, Waveform{{0.4, 0, 0, 0}}, Waveform{{0.36, -0.05, 0, 0}}}) {
    const Unsure most = expect_as_unsure_as_told(wave);
    EXPECT_GT(most.most_spread_rad, 0.03) << wave.harmonic[0] << ' ' << wave.harmonic[1];
    ASSERT_GT(most.alike, 100) << wave.harmonic[0] << ' ' << wave.harmonic[1];
    const double scatter_to_sigma = std::sqrt(most.normalised / most.alike);
    EXPECT_LT(scatter_to_sigma, 1.8) << wave.harmonic[0] << ' ' << wave.harmonic[1];
  }
}

TEST(LevelTable, gives_back_the_cosine_that_was_meant) {
  constexpr double kTold = 0.3;  ///< of F's slope: as the table's own limit, 1/4, and a little
  for (const double gamma : {1.2, 1.5, 1.83, 2.2, 2.47, 2.8}) {
    const Waveform wave = test::gamma_wave(gamma);
    const LevelTable table(wave);
    int told = 0;
    for (int i = 0; i < 4999; ++i) {
      const double c = -1 + 2 * (i + 0.5) / 4999;
      const auto [level, slope] = wave.at(c);
      const auto cosine = static_cast<double>(table.cosine_of(static_cast<float>(level)));
      if (slope > kTold) {
        ASSERT_FALSE(std::isnan(cosine)) << gamma << ' ' << c;
      }
      if (std::isnan(cosine)) continue;
      ++told;
      EXPECT_NEAR(cosine, c, 1e-3) << gamma << ' ' << c;
    }
    EXPECT_GT(told, 4999 * 0.7) << gamma;
  }
}

TEST(LevelTable, noise_beyond_the_wave_goes_on_straight_and_no_level_far_beyond_is_told) {
  const Waveform wave = test::gamma_wave(1.5);
  const LevelTable table(wave);
  const auto [highest, slope] = wave.at(1);
  EXPECT_NEAR(table.cosine_of(static_cast<float>(highest + 0.1)), 1 + 0.1 / slope, 1e-3);
  for (const double beyond : {0.26, 1.0, 100.0}) {
    EXPECT_TRUE(std::isnan(table.cosine_of(static_cast<float>(highest + beyond)))) << beyond;
    EXPECT_TRUE(std::isnan(table.cosine_of(static_cast<float>(wave.at(-1).value - beyond)))) << beyond;
  }
  EXPECT_TRUE(std::isnan(table.cosine_of(std::nanf(""))));
}

TEST(LevelTable, of_a_cosine_is_the_level_itself) {
  const LevelTable table({});
  for (int i = -120; i <= 120; ++i) EXPECT_NEAR(table.cosine_of(static_cast<float>(i) / 100), i / 100.0, 1e-5) << i;
}

TEST(WaveWidening, of_a_cosine_is_one) {
  for (const FrameScheme* frames : {&micro_three_step(), &four_step_three()}) {
    const WaveWidening widening({}, *frames);
    for (int i = 0; i < kPhases; ++i) {
      const auto [factor, spread_rad] = widening.at(static_cast<float>(phase_of(i)));
      EXPECT_NEAR(factor, 1, 1e-3);
      EXPECT_NEAR(spread_rad, 0, 1e-5);
    }
  }
}

/// Of the nearest of 512 phases below: 0.012 rad, over which the factor changes by 0.06 at most.
TEST(WaveWidening, at_a_true_phase_is_between_the_slope_there_and_that_over_what_is_left_of_the_modulation) {
  const Waveform wave = test::gamma_wave(1.8);
  const PhaseTable table(wave, four_step_three());
  const WaveWidening widening(wave, four_step_three());
  for (int i = 0; i < kPhases; ++i) {
    const PhaseTable::Entry e = undo(wave, false, table, phase_of(i)).entry;
    const float factor = widening.at(static_cast<float>(phase_of(i))).factor;
    EXPECT_GE(factor, e.slope * std::min(1.0F, e.scale) - 0.06F) << phase_of(i);
    EXPECT_LE(factor, e.slope * std::max(1.0F, e.scale) + 0.06F) << phase_of(i);
  }
}

}  // namespace
}  // namespace enamel::pipeline
