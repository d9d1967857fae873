// Patterns as commanded: one definition for twin, projector and decoder, and a projector's response undone in them.
#include "calib/model/pattern.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "tests/unit/calib/rig_text.hpp"

namespace enamel::calib {
namespace {

constexpr double kGamma = 1.1;  ///< off a straight line by 3.5 % of full scale: still accepted by calibration

double emission_of(double level) { return std::pow(level / 255, kGamma); }

ProjectorResponse bent(int step) {
  ProjectorResponse r;
  for (int level = 0; level <= 255; level += step) {
    r.level.push_back(level);
    r.emission.push_back(emission_of(level));
  }
  return r;
}

/// Largest distance of what a bent projector emits from what the patterns want, share of full scale.
double worst_emission(const Rig& rig) {
  const PatternTable table = pattern_table(rig);
  double worst = 0;
  for (int frame = 0; frame < 4; ++frame) {
    const auto& line = table.frames[static_cast<std::size_t>(frame)];
    for (std::size_t i = 0; i < line.size(); ++i) {
      const double wanted = pattern_level(rig.patterns, frame, static_cast<int>(i)) / 255;
      worst = std::max(worst, std::abs(emission_of(line[i]) - wanted));
    }
  }
  return worst;
}

TEST(Pattern, response_is_undone_to_the_rounding_of_a_level) {
  Rig rig = parse_rig(test::kRigText).value();
  EXPECT_GT(worst_emission(rig), 0.03);  // control: as commanded without
  rig.response = bent(15);
  EXPECT_LT(worst_emission(rig), 0.5 * kGamma / 255 + 5e-4);
}

TEST(Pattern, straight_response_changes_nothing) {
  Rig rig = parse_rig(test::kRigText).value();
  const PatternTable plain = pattern_table(rig);
  rig.response = ProjectorResponse{.level = {0, 100, 255}, .emission = {0, 100 / 255.0, 1}, .residual = 0};
  EXPECT_EQ(pattern_table(rig).frames, plain.frames);
  rig.response = bent(51);
  EXPECT_NE(pattern_table(rig).frames, plain.frames);
}

TEST(Pattern, levels_beyond_the_measured_ones_stay) {
  ProjectorResponse r{.level = {20, 120, 220}, .emission = {0, 0.3, 1}, .residual = 0.2};
  EXPECT_EQ(level_for(r, 10), 10);
  EXPECT_EQ(level_for(r, 230), 230);
  EXPECT_NEAR(level_for(r, 20 + 0.3 * 200), 120, 1e-9);
  EXPECT_NEAR(level_for(r, 20 + 0.65 * 200), 170, 1e-9);
}

TEST(Pattern, runs_along_the_axis_that_the_rig_states) {
  Rig rig = parse_rig(test::kRigText).value();
  EXPECT_EQ(pattern_table(rig).frames[0].size(), static_cast<std::size_t>(rig.projector.width));
  rig.patterns.axis_v = true;
  EXPECT_EQ(pattern_table(rig).frames[0].size(), static_cast<std::size_t>(rig.projector.height));
}

/// Largest phase, mrad, by which four 90-degree frames of whole fringes of 24 px are off; level(frame, pixel).
template <class Level>
double worst_fringe_mrad(const Level& level) {
  constexpr int kPeriod = 24, kFringes = 35;
  double worst = 0;
  for (int fringe = 0; fringe < kFringes; ++fringe) {
    std::complex<double> sum;
    for (int i = fringe * kPeriod; i < (fringe + 1) * kPeriod; ++i) {
      const std::complex<double> seen(level(0, i) - level(2, i), level(3, i) - level(1, i));
      sum += seen * std::polar(1.0, -2 * std::numbers::pi * i / kPeriod);
    }
    worst = std::max(worst, 1e3 * std::abs(std::arg(sum)));
  }
  return worst;
}

/// With a mean of 127.5 each zero crossing lies half way between two levels.
TEST(Pattern, eight_bit_fringes_all_lie_where_they_should) {
  Rig rig = parse_rig(test::kRigText).value();
  rig.patterns.mode = PatternMode::kPlain4;
  rig.patterns.mean = 127.5;
  const PatternTable table = pattern_table(rig);
  const auto commanded = [&](int frame, int i) {
    return static_cast<double>(table.frames[static_cast<std::size_t>(frame)][static_cast<std::size_t>(i)]);
  };
  EXPECT_LT(worst_fringe_mrad(commanded), 1e-6);
  const auto as_cos_leaves_it = [](int frame, int i) {
    return std::nearbyint(127.5 + 120 * std::cos(2 * std::numbers::pi * i / 24 + frame * std::numbers::pi / 2));
  };
  EXPECT_GT(worst_fringe_mrad(as_cos_leaves_it), 0.5);  // control: ties rounded by the noise of cos
}

TEST(Pattern, polarity_repeats_from_the_first_cell_on) {
  PatternValues p;
  p.mode = PatternMode::kPolarity;
  p.polarity_code = {-1, 1, 1};
  p.first_cell = 1;
  EXPECT_THAT((std::vector<int>{polarity_of_cell(p, 0), polarity_of_cell(p, 1), polarity_of_cell(p, 2),
                                polarity_of_cell(p, -1), polarity_of_cell(p, -4)}),
              testing::ElementsAre(1, 1, -1, -1, -1));
  p.mode = PatternMode::kSingle;
  p.marker_fringe = 2;
  EXPECT_EQ(polarity_of_cell(p, 3), 1);
  EXPECT_EQ(polarity_of_cell(p, 4), -1);
  EXPECT_EQ(polarity_of_cell(p, 5), -1);
  EXPECT_EQ(polarity_of_cell(p, 6), 1);
  p.mode = PatternMode::kPlain4;
  EXPECT_EQ(polarity_of_cell(p, 4), 1);
}

TEST(Pattern, calibration_sets_alone_are_no_bursts) {
  PatternValues p;
  for (const auto mode : {PatternMode::kPlain4, PatternMode::kPolarity, PatternMode::kSingle, PatternMode::kMicro}) {
    p.mode = mode;
    EXPECT_TRUE(is_burst_set(p)) << mode_name(p);
  }
  p.mode = PatternMode::kMulti;
  EXPECT_FALSE(is_burst_set(p));
}

TEST(Pattern, response_is_read_and_one_without_an_inverse_refused) {
  const auto with = [](const std::string& level, const std::string& emission) {
    return parse_rig(test::rig_text_with(
        R"("units": "mm")", R"("units": "mm", "response": {"level": )" + level + R"(, "emission": )" + emission + "}"));
  };
  const auto good = with("[0, 128, 255]", "[0, 0.45, 1]");
  ASSERT_TRUE(good) << good.error().message();
  EXPECT_THAT(good->response->level, testing::ElementsAre(0, 128, 255));
  EXPECT_TRUE(good->unknown_keys.empty());
  for (const auto& [level, emission] :
       std::vector<std::pair<std::string, std::string>>{{"[0, 128, 255]", "[0, 0.45]"},
                                                        {"[0, 255]", "[0, 1]"},
                                                        {"[0, 128, 256]", "[0, 0.45, 1]"},
                                                        {"[0, 1e300, 255]", "[0, 0.45, 1]"},
                                                        {"[128, 0, 255]", "[0, 0.45, 1]"},
                                                        {"[0, 64, 128, 255]", "[0, 0.3, 0.2, 1]"},
                                                        {"[0, 64, 128, 255]", "[0, 0.3, 0.3, 1]"},
                                                        {"[0, 128, 255]", "[0.1, 0.45, 1]"},
                                                        {"[0, 128, 255]", "7"}}) {
    const auto bad = with(level, emission);
    ASSERT_FALSE(bad) << level << emission;
    EXPECT_THAT(bad.error().message(), testing::HasSubstr("response.emission"));
  }
}

}  // namespace
}  // namespace enamel::calib
