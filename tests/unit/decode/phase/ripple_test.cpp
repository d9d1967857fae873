// Self-calibration of ripple: from harmonics of the projector (phase_ripple) and from single frames that differ
// (frame_errors).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/decode/mode_t/frame_errors.hpp"
#include "pipeline/decode/phase/phase_ripple.hpp"
#include "tests/support/fold_error.hpp"
#include "tests/support/gamma_scene.hpp"
#include "tests/support/half_fringes.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

class Gamma : public testing::TestWithParam<double> {};

TEST_P(Gamma, ten_bursts_bring_the_ripple_to_a_ninth_of_the_double_three_step) {
  for (const double noise : {0.0, 0.02}) {
    const auto r = test::measure_gamma({.gamma = GetParam(), .noise = noise, .width = 320, .height = 240}, 10);
    EXPECT_LE(r.levelled, r.double_three_step / 9)
        << "noise " << noise << ": three " << r.three_step << " double " << r.double_three_step << " four "
        << r.four_step << " one term " << r.one_term << " levelled " << r.levelled;
  }
}

TEST_P(Gamma, one_burst_reaches_a_ninth_of_the_uncorrected_or_a_thousandth) {
  const auto r = test::measure_gamma({.gamma = GetParam(), .noise = 0.02}, 1);
  EXPECT_LE(r.levelled, std::max(r.four_step / 9, 1e-3)) << r.four_step;
}

INSTANTIATE_TEST_SUITE_P(OneThreeToTwoEight, Gamma, testing::Values(1.3, 1.5, 1.8, 2.2, 2.5, 2.8));

TEST(PhaseRipple, moments_of_half_a_fringe_are_no_calibration) {  // why only whole fringes count
  std::vector<float> half(1000), whole(1000);
  for (std::size_t k = 0; k < half.size(); ++k) {
    half[k] = 0.3F + 0.0005F * static_cast<float>(k);
    whole[k] = -3.14159265F + 6.2831853F * (static_cast<float>(k) + 0.5F) / 1000;
  }
  EXPECT_GT(std::abs(level(phase_moments(half)).sine[0]), 0.05);
  EXPECT_LT(std::abs(level(phase_moments(whole)).sine[0]), 1e-5);
  EXPECT_EQ(level(PhaseMoments{}).sine[0], 0);
}

/// A row's half fringes, of true phase.
void add_cells(const std::vector<double>& phi, int row, int width, std::vector<CellSpan>& spans) {
  const auto cell_at = [&](int u) {
    const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
    return static_cast<std::int32_t>(std::floor(phi[i] / std::numbers::pi));
  };
  test::cut_half_fringes(row, width, cell_at, spans);
}

/// Amplitude of cos 4 phi that 200 rows seem to have whose measured phase at pixel u is `phase`(u, offset of the row).
template <class Phase>
double seeming_cosine(const Phase& phase, bool cells_in_order) {
  constexpr int kWidth = 320, kHeight = 200;
  PhaseMaps maps;
  for (Map<float>* map : {&maps.cosine_dn, &maps.sine_dn, &maps.phase_rad}) *map = Map<float>(kWidth, kHeight);
  std::vector<double> phi;
  std::vector<CellSpan> spans;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      phi.push_back(phase(u, 0.37 * v));
      maps.cosine_dn(u, v) = static_cast<float>(50 * std::cos(phi.back()));
      maps.sine_dn(u, v) = static_cast<float>(50 * std::sin(phi.back()));
      maps.phase_rad(u, v) = static_cast<float>(test::wrap_pi(phi.back()));
    }
    add_cells(phi, v, kWidth, spans);
  }
  if (!cells_in_order)
    for (CellSpan& s : spans) s.cell &= 1;
  return level(phase_moments(spans, maps)).cosine[0];
}

TEST(PhaseRipple, curved_surfaces_whose_fringes_grow_along_the_row_show_none) {
  const auto growing = [](double sign) {  // half fringes of 20 px at one end of the row, of 8 at the other
    return [sign](int u, double offset) {
      const double x = sign > 0 ? u : 319 - u;
      return offset + std::numbers::pi * (x / 20 + x * x * (1.0 / 8 - 1.0 / 20) / 640);
    };
  };
  for (const double sign : {1.0, -1.0}) {
    EXPECT_NEAR(seeming_cosine(growing(sign), true), 0, 3e-4);
    EXPECT_GT(std::abs(seeming_cosine(growing(sign), false)), 1e-3);  // the control: not told what lies beside what
  }
}

TEST(PhaseRipple, half_fringes_that_ripple_makes_differ_are_no_curvature) {
  const auto uneven = [](int u, double offset) {
    const double phi = offset + std::numbers::pi * u / 13;
    return phi + 0.1 * std::cos(phi);
  };
  EXPECT_NEAR(seeming_cosine(uneven, true), seeming_cosine(uneven, false), 1e-4);
}

/// Edges and glints leave pixels whose corrected phase is far from the angle of their C and S.
TEST(PhaseRipple, pixels_far_from_their_angle_count_as_one_each) {
  constexpr int kWidth = 480, kPeriod = 24;
  PhaseMaps maps;
  for (Map<float>* map : {&maps.cosine_dn, &maps.sine_dn, &maps.phase_rad}) *map = Map<float>(kWidth, 1);
  for (int u = 0; u < kWidth; ++u) {
    const double phi = 2 * std::numbers::pi * (u + 0.5) / kPeriod;
    maps.cosine_dn(u, 0) = static_cast<float>(50 * std::cos(phi));
    maps.sine_dn(u, 0) = static_cast<float>(50 * std::sin(phi));
    maps.phase_rad(u, 0) = static_cast<float>(test::wrap_pi(phi + (u % 60 == 7 ? 1.5 : 0.0)));  // 8 of 480
  }
  const std::vector<CellSpan> spans{{0, 0, kWidth, 0, true}};
  const PhaseRipple ripple = level(phase_moments(spans, maps));
  for (std::size_t m = 0; m < kRippleTerms; ++m) {
    const double most = 2 * 8.0 / kWidth / (2.0 * static_cast<double>(m + 1));  // all 8 the same way
    EXPECT_LE(std::hypot(ripple.cosine[m], ripple.sine[m]), most + 1e-4) << m;
  }
}

TEST(PhaseRipple, an_unsymmetric_ripple_of_four_terms_is_taken_out) {
  const auto error = [](double p) {
    return 0.02 * std::sin(4 * p + 0.3) + 0.014 * std::cos(8 * p + 2) + 0.003 * std::sin(12 * p);
  };
  std::vector<float> measured;
  std::vector<double> truth;
  for (int k = 0; k < 20000; ++k) {
    truth.push_back(-std::numbers::pi + 2 * std::numbers::pi * k / 20000);
    measured.push_back(static_cast<float>(truth.back() + error(truth.back())));
  }
  const auto rms = [&] {
    test::ErrorFolder folder;
    for (std::size_t k = 0; k < truth.size(); ++k)
      folder.add(test::wrap_pi(static_cast<double>(measured[k]) - truth[k]), truth[k]);
    return folder.result().rms_rad;
  };
  const double before = rms();
  const PhaseMoments moments = phase_moments(measured);
  std::vector<float> one = measured;
  correct_phase(level(moments, 1), one);
  correct_phase(level(moments), measured);
  EXPECT_GT(before, 0.015);
  EXPECT_LT(rms(), before / 9);
  measured = one;
  EXPECT_GT(rms(), before / 3);  // the control: one term is not enough for such a waveform
}

struct FramesOf {
  PhaseMaps maps;
  PolarityMaps polarity;
  std::vector<CellSpan> spans;
  std::vector<double> truth;
};

/// What single frames do differently: all light, background alone (both as a share), place of the pattern (rad).
struct Deviations {
  std::array<double, 4> gain{}, background{}, shift{};
  double texture = 0;  ///< of the surface, which all frames see: tiles darker by up to this share
};

/// Tiles of 13 x 9 px, each as dark as its number says, 0 to 1.
double tile_of(int u, int v) {
  const auto number = static_cast<std::uint32_t>(u / 13 + 100 * (v / 9));
  return static_cast<double>((number * 2654435761U) >> 8U) / (1U << 24U);
}

/// 8 bit, noisy, unequal reflectance and focus.
FramesOf frames_with(const Deviations& d) {
  constexpr int kWidth = 320, kHeight = 200;
  test::FrameSet set{kWidth, kHeight, {}};
  test::Normals normal(5);
  FramesOf out;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double phi = 2 * std::numbers::pi * (u + 0.3 * v) / 29.7;
      const double smooth = 0.7 + 0.3 * std::sin(0.05 * u) * std::cos(0.07 * v), focus = 0.6 + 0.1 * std::sin(0.01 * u);
      const double albedo = smooth * (1 - d.texture * tile_of(u, v));
      out.truth.push_back(phi);
      for (std::size_t k = 0; k < 4; ++k) {
        const double wave = std::cos(phi + static_cast<double>(k) * std::numbers::pi / 2 + d.shift[k]);
        const double dn = albedo * 100 * (1 + d.gain[k]) * (1 + d.background[k] + focus * wave) + normal();
        set.frames[k].push_back(static_cast<std::uint8_t>(std::clamp(std::lround(dn), 0L, 255L)));
      }
    }
  }
  NoiseModel noise;
  noise.floor_dn2 = 1.1F;
  compute_phase(set.view(), noise, {}, out.maps);
  for (int v = 0; v < kHeight; ++v) add_cells(out.truth, v, kWidth, out.spans);
  apply_polarity(out.spans, {std::vector<float>(64, 1.0F), false}, noise, {}, out.maps, out.polarity);
  return out;
}

double ripple(const FramesOf& f) {
  test::ErrorFolder folder;
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    folder.add(test::wrap_pi(static_cast<double>(f.maps.phase_rad[i]) - f.truth[i]), f.truth[i]);
  return folder.result().repeating_rad;
}

TEST(FrameErrors, one_frame_of_other_background_and_one_shifted_leave_no_ripple) {
  FramesOf f = frames_with({.background = {0, -0.03, 0, 0}, .shift = {0, 0, 0, 0.04}});
  const double before = ripple(f);
  correct_frame_errors(f.spans, f.polarity, 0, {}, f.maps);
  EXPECT_GT(before, 0.015);
  EXPECT_LT(ripple(f), before / 8);
}

TEST(FrameErrors, flicker_of_all_light_leaves_no_ripple) {
  FramesOf f = frames_with({.gain = {0.01, -0.03, 0, 0}});
  const double before = ripple(f);
  correct_frame_errors(f.spans, f.polarity, 0, {}, f.maps);
  EXPECT_GT(before, 0.015);
  EXPECT_LT(ripple(f), before / 8);
}

TEST(FrameErrors, good_frames_are_left_alone) {
  FramesOf f = frames_with({});
  const double before = ripple(f);
  const FrameErrors e = correct_frame_errors(f.spans, f.polarity, 0, {}, f.maps);
  for (const double value : {e.offset_cos, e.offset_sin, e.squeeze, e.shear}) EXPECT_LT(std::abs(value), 1e-3);
  EXPECT_LT(ripple(f), before + 1e-3);
}

TEST(FrameErrors, tiles_of_texture_are_not_taken_for_errors_of_frames) {
  FramesOf good = frames_with({.texture = 0.3});
  const FrameErrors e = correct_frame_errors(good.spans, good.polarity, 0, {}, good.maps);
  for (const double value : {e.offset_cos, e.offset_sin, e.squeeze, e.shear}) EXPECT_LT(std::abs(value), 2e-3);
  FramesOf f = frames_with({.background = {0, -0.03, 0, 0}, .shift = {0, 0, 0, 0.04}, .texture = 0.3});
  const double before = ripple(f);
  correct_frame_errors(f.spans, f.polarity, 0, {}, f.maps);
  EXPECT_LT(ripple(f), before / 8);
}

TEST(FrameErrors, without_a_whole_cell_there_is_no_estimate) {
  FramesOf f = frames_with({.gain = {0.1, 0, 0, 0}});
  for (CellSpan& s : f.spans) s.whole = false;
  EXPECT_EQ(correct_frame_errors(f.spans, f.polarity, 0, {}, f.maps).pixels, 0);
}

TEST(FrameErrors, few_pixels_give_no_estimate) {
  FramesOf f = frames_with({.gain = {0.1, 0, 0, 0}});
  const std::vector<CellSpan> few(f.spans.begin(), f.spans.begin() + 200);
  EXPECT_EQ(correct_frame_errors(few, f.polarity, 0, {}, f.maps).pixels, 0);
}

}  // namespace
}  // namespace enamel::pipeline
