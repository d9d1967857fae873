// Four frames, each at its own time and under its own light, brought to mid-burst by what is known of both.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "tests/unit/decode/dsim.hpp"

namespace enamel::pipeline {
namespace {

using namespace test::dsim;  // NOLINT: the vocabulary of these tests

constexpr int kPhases = 720;
constexpr double kMean = 100, kModulation = 80, kBlack = 4;

struct Change {
  float rate = 0, rate_change = 0, light = 0, light_change = 0, harmonic = 0;

  [[nodiscard]] BurstErrors errors() const {
    const auto grid = [](const float& value) { return Grid{&value, 1, 1, 8}; };
    return {grid(rate), grid(harmonic), grid(light), grid(rate_change), grid(light_change)};
  }
};

/// A row of pixels whose phases cover a fringe, as apply_polarity leaves them. weight: b w of polarity.hpp.
struct Row {
  PhaseMaps maps;
  PolarityMaps polarity;
  std::vector<double> phases = even_phases(kPhases);

  Row(const Change& change, float weight) {
    for (auto* map :
         {&maps.phase_rad, &maps.mean_dn, &maps.cosine_dn, &maps.sine_dn, &maps.code_dn, &maps.modulation_dn})
      *map = Map<float>(kPhases, 1);
    polarity.weight = Map<float>(kPhases, 1);
    std::fill(polarity.weight.pixels().begin(), polarity.weight.pixels().end(), weight);
    const double b = weight < 0 ? -1 : 1, w = std::abs(static_cast<double>(weight));
    for (std::size_t i = 0; i < kPhases; ++i) {
      const auto frame = [&](int k) { return frame_of(change, phases[i], k, b); };
      const double a = (frame(0) + frame(2)) / 2, c = (frame(0) - frame(2)) / 2, s3 = a - frame(1), d = frame(3) - a;
      const double s = s3 + w / 2 * (b * d - s3);
      maps.mean_dn[i] = static_cast<float>(a + kBlack);
      maps.cosine_dn[i] = static_cast<float>(c), maps.sine_dn[i] = static_cast<float>(s);
      maps.code_dn[i] = static_cast<float>(s3 - b * d);
      maps.modulation_dn[i] = static_cast<float>(std::hypot(c, s));
      maps.phase_rad[i] = static_cast<float>(std::atan2(s, c));
    }
  }

  static double frame_of(const Change& change, double phase, int k, double b) {
    const double t = k - 1.5;
    const auto at = [t](float first, float second) {
      return static_cast<double>(first) * t + static_cast<double>(second) * t * t / 2;
    };
    const double shift = (k == 3 && b < 0 ? 1 : k) * kPi / 2;
    const double p = phase + shift + at(change.rate, change.rate_change);
    const double wave = std::cos(p) + static_cast<double>(change.harmonic) * std::cos(2 * p);
    return (1 + at(change.light, change.light_change)) * (kMean + kModulation * wave);
  }

  [[nodiscard]] double worst_error(const Change& known) {
    const Map<float> measured = maps.phase_rad;
    correct_phase(polarity, known.errors(), static_cast<float>(kBlack), maps);
    double worst = 0;
    for (std::size_t i = 0; i < kPhases; ++i)
      worst = std::max(worst, std::abs(wrap(static_cast<double>(maps.phase_rad[i]) - phases[i])));
    maps.phase_rad = measured;
    return worst;
  }

  /// Largest residual about what is known, over the modulation.
  [[nodiscard]] double worst_left(const Change& known, double harmonic) {
    std::vector<float> columns(4 * std::size_t{kPhases});
    float* left = columns.data();
    ErrorRows rows(known.errors(), static_cast<float>(kBlack), kPhases);
    left_row(pixel_row(maps, rows.at(polarity, 0), 0), kPhases,
             {left, left + kPhases, left + 2 * kPhases, left + 3 * kPhases});
    double worst = 0;
    for (std::size_t i = 0; i < kPhases; ++i) {
      const double rest = static_cast<double>(left[i]) - harmonic * static_cast<double>(left[3 * kPhases + i]);
      worst = std::max(worst, std::abs(rest) / kModulation);
    }
    return worst;
  }
};

constexpr Change kMoving{.rate = 0.12F, .rate_change = 0.012F, .light = -0.06F, .light_change = 0.02F};

TEST(ClosureRefit, undoes_motion_and_light_exactly_however_a_pixel_was_solved) {
  for (const float weight : {1.0F, -1.0F, 0.6F, -0.6F, 0.0F}) {
    Row row(kMoving, weight);
    EXPECT_LT(row.worst_error(kMoving), 5e-6) << weight;
    Change first_order = kMoving;
    first_order.rate_change = first_order.light_change = 0;
    EXPECT_GT(row.worst_error(first_order), 0.005) << "negative control: how both change during the burst, " << weight;
  }
}

TEST(ClosureRefit, harmonic_of_a_moving_surface_is_undone_with_its_motion) {
  Change change = kMoving;
  change.harmonic = -0.015F;
  for (const float weight : {1.0F, -1.0F, 0.0F}) {
    Row row(change, weight);
    EXPECT_LT(row.worst_error(change), 0.0012) << weight << ": of second order in the harmonic";
    EXPECT_GT(row.worst_error(kMoving), 0.004) << "negative control: without it, " << weight;
  }
}

TEST(ClosureRefit, nothing_is_left_of_the_residual_when_all_is_known) {
  Change change = kMoving;
  change.harmonic = -0.015F;
  for (const float weight : {1.0F, -1.0F}) {
    Row row(change, weight);
    EXPECT_LT(row.worst_left(change, -0.015), 0.002) << weight;
    Change slower = change;
    slower.rate = 0.11F;
    EXPECT_GT(row.worst_left(slower, -0.015), 0.015) << "negative control: a motion off by 0.01 rad, " << weight;
    EXPECT_GT(row.worst_left(change, 0), weight > 0 ? 0.04 : 0.002) << "negative control: the harmonic left out";
  }
}

}  // namespace
}  // namespace enamel::pipeline
