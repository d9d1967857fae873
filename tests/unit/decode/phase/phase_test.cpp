#include "pipeline/decode/phase/phase.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/types/simd.hpp"
// simd.hpp says for which sets the decoder is compiled.
#include <hwy/highway.h>

#include "pipeline/decode/mode_t/cell_signs.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "tests/support/four_step.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

TEST(PolyTrig, arctangent_stays_below_its_error_bound_all_around) {
  double worst = 0;
  for (int k = 0; k < 400'000; ++k) {
    const double a = -std::numbers::pi + 2 * std::numbers::pi * (k + 0.5) / 400'000;
    const auto x = static_cast<float>(80 * std::cos(a)), y = static_cast<float>(80 * std::sin(a));
    const double exact = std::atan2(static_cast<double>(y), static_cast<double>(x));
    worst = std::max(worst, std::abs(static_cast<double>(atan2_poly(y, x)) - exact));
  }
  EXPECT_LT(worst, 4e-7);
}

TEST(PolyTrig, arctangent_knows_the_axes) {
  EXPECT_EQ(atan2_poly(0, 0), 0.0F);
  EXPECT_EQ(atan2_poly(0, 3), 0.0F);
  EXPECT_NEAR(atan2_poly(3, 0), kPiF / 2, 1e-6);
  EXPECT_NEAR(atan2_poly(-3, 0), -kPiF / 2, 1e-6);
  EXPECT_NEAR(atan2_poly(0, -3), kPiF, 1e-6);
  EXPECT_NEAR(atan2_poly(-0.0F, -3), -kPiF, 1e-6);
}

/// Any values.
test::FrameSet arbitrary_frames(int width, int height, int bit_depth) {
  test::FrameSet f{width, height, {}, bit_depth};
  std::uint32_t state = 7;
  for (auto& frame : f.frames) {
    for (int i = 0; i < width * height; ++i) {
      state = state * 1664525U + 1013904223U;
      frame.push_back(static_cast<std::uint8_t>(state >> 24U));
      if (bit_depth > 8) frame.push_back(static_cast<std::uint8_t>((state >> 16U) & 0x0FU));
    }
  }
  return f;
}

/// Every two differences of 8-bit frames: I3 - I1 along v, I0 - I2 along u, -255 ... 255.
test::FrameSet all_differences() {
  test::FrameSet f{511, 511, {}};
  for (int v = -255; v <= 255; ++v) {
    for (int u = -255; u <= 255; ++u) {
      const std::array<int, 4> values{std::max(u, 0), std::max(-v, 0), std::max(-u, 0), std::max(v, 0)};
      for (std::size_t k = 0; k < 4; ++k) f.frames[k].push_back(static_cast<std::uint8_t>(values[k]));
    }
  }
  return f;
}

/// Errors against the textbook's formula in double: of the phase, rad, and of the modulation, as share of it.
struct WorstErrors {
  double phase_rad = 0, modulation = 0;
};

WorstErrors errors_of_four_step(const test::FrameSet& f) {
  const auto value = [&](std::size_t k, std::size_t i) {
    return f.bit_depth == 8 ? f.frames[k][i] : f.frames[k][2 * i] + 256 * f.frames[k][2 * i + 1];
  };
  Map<float> phase, modulation;
  test::four_step(f.view(), phase, modulation);
  EXPECT_EQ(phase.size(), static_cast<std::size_t>(f.width * f.height));
  WorstErrors worst;
  for (std::size_t i = 0; i < phase.size(); ++i) {
    const double s = 0.5 * (value(3, i) - value(1, i)), c = 0.5 * (value(0, i) - value(2, i)), b = std::hypot(s, c);
    worst.phase_rad = std::max(worst.phase_rad, std::abs(static_cast<double>(phase[i]) - std::atan2(s, c)));
    worst.modulation =
        std::max(worst.modulation, std::abs(static_cast<double>(modulation[i]) - b) / std::max(b, 1e-30));
  }
  return worst;
}

TEST(FourStep, is_the_textbooks_phase_and_modulation) {
  const WorstErrors of_8_bit = errors_of_four_step(all_differences());
  EXPECT_LT(of_8_bit.phase_rad, 7e-7);
  EXPECT_LT(of_8_bit.modulation, 2e-7);
  for (const int bit_depth : {8, 12}) {
    for (const int width : {1, 3, 16, 17, 600}) {
      const WorstErrors worst = errors_of_four_step(arbitrary_frames(width, 3, bit_depth));
      EXPECT_LT(worst.phase_rad, 7e-7) << bit_depth << " bit, " << width << " px";
      EXPECT_LT(worst.modulation, 2e-7) << bit_depth << " bit, " << width << " px";
    }
  }
}

TEST(FourStep, gives_the_same_bits_on_every_instruction_set) {
  const test::FrameSet f = all_differences();
  Map<float> phase, modulation;
  test::four_step(f.view(), phase, modulation);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    Map<float> other_phase, other_modulation;
    test::four_step(f.view(), other_phase, other_modulation);
    EXPECT_TRUE(std::ranges::equal(phase.pixels(), other_phase.pixels())) << hwy::TargetName(target);
    EXPECT_TRUE(std::ranges::equal(modulation.pixels(), other_modulation.pixels())) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(FourStep, gives_zeros_where_the_frames_are_alike) {
  const test::FrameSet f{1, 1, {{{90}, {90}, {90}, {90}}}};
  Map<float> phase, modulation;
  test::four_step(f.view(), phase, modulation);
  EXPECT_EQ(phase[0], 0);
  EXPECT_EQ(modulation[0], 0);
}

NoiseModel quiet() { return noise_from_rig(*test::cropped_rig(8, 8).noise, 8); }

PixelReject verdict_of(std::array<std::uint8_t, 4> dn) {
  test::FrameSet f{1, 1, {}};
  for (std::size_t k = 0; k < 4; ++k) f.frames[k] = {dn[k]};
  PhaseMaps maps;
  compute_phase(f.view(), quiet(), {}, maps);
  return maps.reject[0];
}

TEST(PhaseMask, each_physical_limit_rejects_under_its_own_name) {
  EXPECT_EQ(verdict_of({200, 120, 40, 120}), PixelReject::kNone);
  EXPECT_EQ(verdict_of({5, 4, 4, 5}), PixelReject::kDark);
  EXPECT_EQ(verdict_of({120, 60, 0, 60}), PixelReject::kDark);  // clipped at zero
  EXPECT_EQ(verdict_of({255, 120, 40, 120}), PixelReject::kSaturated);
  EXPECT_EQ(verdict_of({100, 100, 99, 100}), PixelReject::kNoisy);
}

TEST(PhaseMask, saturated_fourth_frame_leaves_the_three_frame_solution) {
  test::FrameSet f{1, 1, {}};
  f.frames = {{{160}, {40}, {160}, {255}}};
  PhaseMaps maps;
  compute_phase(f.view(), quiet(), {}, maps);
  EXPECT_EQ(maps.reject[0], PixelReject::kNone);
  EXPECT_TRUE(std::isnan(maps.code_dn[0]));
  EXPECT_NEAR(maps.phase_rad[0], std::numbers::pi / 2, 1e-6);
}

TEST(Phase, three_frames_give_the_phase_whatever_the_polarity) {
  const calib::Rig rig = test::cropped_rig(160, 20);
  const auto burst = test::render(rig, test::flat(48));
  PhaseMaps maps;
  compute_phase(burst.frames.view(), quiet(), {}, maps);
  for (std::size_t i = 0; i < maps.phase_rad.size(); ++i) {
    const double e = std::remainder(static_cast<double>(maps.phase_rad[i]) - burst.phase_rad[i], 2 * std::numbers::pi);
    ASSERT_LT(std::abs(e), 0.016);  // rounding to whole DN: at most 1.2 DN of 80
  }
}

TEST(Phase, sixteen_bit_frames_decode_like_eight_bit_ones) {
  test::FrameSet f{1, 1, {}};
  f.frames = {{{200}, {90}, {40}, {150}}};
  PhaseMaps eight, sixteen;
  compute_phase(f.view(), quiet(), {}, eight);
  std::array<std::vector<std::uint8_t>, 4> wide;
  for (std::size_t k = 0; k < 4; ++k) wide[k] = {0, f.frames[k][0]};  // value * 256
  BurstView view{1, 1, 16, {}};
  for (std::size_t k = 0; k < 4; ++k) view.frames[k] = wide[k];
  ASSERT_TRUE(view.is_consistent());
  compute_phase(view, noise_from_rig(*test::cropped_rig(8, 8).noise, 16), {}, sixteen);
  EXPECT_EQ(eight.phase_rad[0], sixteen.phase_rad[0]);
}

TEST(NoiseModel, closure_estimate_finds_the_sensor_that_made_the_burst) {
  const calib::Rig rig = test::cropped_rig(240, 160);
  test::SceneOptions o;
  o.noise = true;
  const auto burst = test::render(rig, test::flat(48), o);
  const NoiseModel truth = noise_from_rig(*rig.noise, 8), seen = noise_from_closure(burst.frames.view());
  EXPECT_EQ(seen.source, NoiseSource::kClosure);
  for (const float dn : {40.0F, 100.0F, 180.0F})
    EXPECT_NEAR(std::sqrt(seen.variance(dn) / truth.variance(dn)), 1.0F, 0.2F) << dn;
}

TEST(CellSigns, follow_code_and_first_cell_cyclically) {
  calib::Rig rig = test::cropped_rig(8, 8);
  rig.patterns.first_cell = 3;
  const CellSigns cells = make_cell_signs(rig.patterns, rig.projector).value();
  ASSERT_GE(cells.cells(), 2 * 854 / 24);
  for (int c = 0; c < cells.cells(); ++c)
    EXPECT_EQ(cells.at(c), static_cast<float>(rig.patterns.polarity_code[static_cast<std::size_t>((c + 3) % 16)]));
  EXPECT_TRUE(cells.informative);
}

TEST(CellSigns, single_marker_is_one_fringe_and_plain_says_nothing) {
  calib::Rig rig = test::cropped_rig(8, 8);
  rig.patterns.mode = calib::PatternMode::kSingle;
  rig.patterns.marker_fringe = 5;
  const CellSigns single = make_cell_signs(rig.patterns, rig.projector).value();
  for (int c = 0; c < single.cells(); ++c) EXPECT_EQ(single.at(c) < 0, c == 10 || c == 11) << c;
  rig.patterns.mode = calib::PatternMode::kPlain4;
  EXPECT_FALSE(make_cell_signs(rig.patterns, rig.projector).value().informative);
}

TEST(CellSigns, refuse_sets_that_have_no_four_step_solution) {
  calib::Rig rig = test::cropped_rig(8, 8);
  for (const auto mode : {calib::PatternMode::kMicro, calib::PatternMode::kMulti}) {
    rig.patterns.mode = mode;
    EXPECT_EQ(make_cell_signs(rig.patterns, rig.projector).error().code, ErrorCode::kPatternSet);
  }
  rig.patterns.mode = calib::PatternMode::kPolarity;
  rig.patterns.axis_v = true;
  EXPECT_EQ(make_cell_signs(rig.patterns, rig.projector).error().code, ErrorCode::kPatternSet);
}

TEST(CellSigns, windows_that_repeat_within_the_depth_range_are_named) {
  calib::Rig rig = test::cropped_rig(8, 8);
  const auto check = [&](std::initializer_list<int> code, double span) {
    rig.patterns.polarity_code = code;
    return check_windows_differ(make_cell_signs(rig.patterns, rig.projector).value(), span);
  };
  EXPECT_TRUE(check_windows_differ(make_cell_signs(rig.patterns, rig.projector).value(), 4.6));  // the probe's own code
  const auto repeats = check({1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1, 1}, 2.5);
  ASSERT_FALSE(repeats);
  EXPECT_EQ(repeats.error().code, ErrorCode::kPatternAmbiguous);
  EXPECT_NE(repeats.error().detail.find("half fringes) at two of the 3 fringe orders"), std::string::npos)
      << repeats.error().detail;
  // The same code, with a depth range of one order: nothing to tell apart.
  EXPECT_TRUE(check({1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1, 1}, 0.9));
  // The longest window is the one that is named: five cells, two fringes apart.
  const auto five = check({1, 1, -1, -1, 1, 1, -1, -1, 1, -1, 1, -1, -1, 1, 1, 1}, 2.5);
  ASSERT_FALSE(five);
  EXPECT_NE(five.error().detail.find("(5 half fringes)"), std::string::npos) << five.error().detail;
}

}  // namespace
}  // namespace enamel::pipeline
