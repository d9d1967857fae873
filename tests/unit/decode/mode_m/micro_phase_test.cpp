#include "pipeline/decode/mode_m/micro_phase.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(PolyTrig, sine_and_cosine_stay_below_their_error_bound) {
  double worst = 0;
  for (int k = -100'000; k <= 100'000; ++k) {
    const auto x = static_cast<float>(k * kPi / 2 / 100'000);
    worst = std::max(worst, std::abs(static_cast<double>(sin_poly(x)) - std::sin(static_cast<double>(x))));
    worst = std::max(worst, std::abs(static_cast<double>(cos_poly(x)) - std::cos(static_cast<double>(x))));
  }
  EXPECT_LT(worst, 2e-7);
}

TEST(PolyTrig, logarithm_stays_below_its_error_bound_over_all_magnitudes) {
  double worst = 0, edge = 0;
  for (int k = -400'000; k <= 400'000; ++k) {
    const auto x = static_cast<float>(std::pow(10, k * 1e-4 * 0.9));  // 10^-36 ... 10^36
    const double truth = std::log(static_cast<double>(x));
    worst = std::max(worst, std::abs(static_cast<double>(log_poly(x)) - truth) / std::max(1.0, std::abs(truth)));
  }
  for (const float x : {0.70710677F, 0.70710683F, 0.99999994F, 1.0F, 1.0000001F, 1.4142135F, 1.4142137F, 2.0F})
    edge = std::max(edge, std::abs(static_cast<double>(log_poly(x)) - std::log(static_cast<double>(x))));
  EXPECT_LT(worst, 2e-7);
  EXPECT_LT(edge, 2e-7);
  EXPECT_EQ(log_poly(1.0F), 0.0F);
}

/// A strip of 16-bit frames whose phase runs through `fringes` fringes, with constant noise: nothing but mode M's
/// pattern, no optics.
struct Strip {
  int width = 0, height = 0;
  std::array<std::vector<std::uint8_t>, 4> bytes;
  std::vector<double> phase_rad;

  [[nodiscard]] BurstView view() const {
    BurstView v{width, height, 16, {}};
    for (std::size_t k = 0; k < 4; ++k) v.frames[k] = bytes[k];
    return v;
  }
};

struct StripOptions {
  double mean = 30000, modulation = 20000, sigma = 0;  // of 65535
  double harmonic = 0, motion_rad = 0, fringes = 40;
};

Strip make_strip(int width, int height, const StripOptions& o) {
  const calib::PatternValues pattern = test::micro_rig(8, 8).patterns;
  Strip s{width, height, {}, {}};
  test::Normals normal(3);
  for (int i = 0; i < width * height; ++i) {
    const double phi = 2 * kPi * o.fringes * ((i % width) + 0.37) / width;
    s.phase_rad.push_back(phi);
    for (int k = 0; k < 4; ++k) {
      double dn = o.mean + o.modulation * test::frame_wave(pattern, k, phi + o.motion_rad * (k - 1.5), o.harmonic);
      if (o.sigma > 0) dn += o.sigma * normal();
      const auto value = static_cast<std::uint16_t>(std::clamp(std::lround(dn), 0L, 65535L));
      s.bytes[static_cast<std::size_t>(k)].push_back(static_cast<std::uint8_t>(value & 255U));
      s.bytes[static_cast<std::size_t>(k)].push_back(static_cast<std::uint8_t>(value >> 8U));
    }
  }
  return s;
}

NoiseModel constant_noise(double sigma) {
  NoiseModel n;
  n.floor_dn2 = static_cast<float>(sigma * sigma);
  n.full_scale_dn = 65535;
  return n;
}

double error_of(float phase, double truth) { return std::remainder(static_cast<double>(phase) - truth, 2 * kPi); }

double worst_error(const PhaseMaps& maps, const Strip& s) {
  double worst = 0;
  for (std::size_t i = 0; i < s.phase_rad.size(); ++i)
    worst = std::max(worst, std::abs(error_of(maps.phase_rad[i], s.phase_rad[i])));
  return worst;
}

TEST(MicroPhase, without_noise_is_exact) {
  const Strip s = make_strip(1000, 2, {});
  PhaseMaps maps;
  compute_micro_phase(s.view(), constant_noise(1), {}, maps);
  EXPECT_LT(worst_error(maps, s), 1e-4);
  for (std::size_t i = 0; i < s.phase_rad.size(); ++i) {
    ASSERT_NEAR(maps.mean_dn[i], 30000, 2);
    ASSERT_NEAR(maps.modulation_dn[i], 20000, 2);
    ASSERT_NEAR(maps.code_dn[i], 20000 * std::cos(s.phase_rad[i] * 7 / 6), 2);
  }
  PhaseMaps wrong;  // negative control: the same frames read as four steps
  compute_phase(s.view(), constant_noise(1), {}, wrong);
  EXPECT_GT(worst_error(wrong, s), 1.0);
}

TEST(MicroPhase, sigma_is_that_of_the_scatter) {
  for (const double share : {0.01, 0.05, 0.1, 0.15}) {
    StripOptions o;
    o.sigma = share * o.modulation;
    const Strip s = make_strip(1000, 100, o);
    PhaseMaps maps;
    compute_micro_phase(s.view(), constant_noise(o.sigma), {}, maps);
    double normalised = 0;
    for (std::size_t i = 0; i < s.phase_rad.size(); ++i)
      normalised += std::pow(error_of(maps.phase_rad[i], s.phase_rad[i]) / static_cast<double>(maps.sigma_rad[i]), 2);
    EXPECT_NEAR(std::sqrt(normalised / static_cast<double>(s.phase_rad.size())), 1.0, 0.05) << share;
    // The bound of three steps, up to the noise of B that the prediction is made with.
    EXPECT_NEAR(static_cast<double>(maps.sigma_rad[7]), std::sqrt(2.0 / 3) * share, 0.4 * share);
  }
}

PixelReject verdict_of(std::array<std::uint8_t, 4> dn, PhaseMaps& maps) {
  test::FrameSet f{1, 1, {}};
  for (std::size_t k = 0; k < 4; ++k) f.frames[k] = {dn[k]};
  compute_micro_phase(f.view(), noise_from_rig(*test::cropped_rig(8, 8).noise, 8), {}, maps);
  return maps.reject[0];
}

TEST(MicroPhase, mask_judges_the_phase_frames_and_spares_the_code_frame) {
  PhaseMaps maps;
  EXPECT_EQ(verdict_of({200, 120, 80, 80}, maps), PixelReject::kNone);
  EXPECT_EQ(verdict_of({5, 4, 4, 5}, maps), PixelReject::kDark);
  EXPECT_EQ(verdict_of({200, 120, 80, 0}, maps), PixelReject::kDark);  // clipped at zero
  EXPECT_EQ(verdict_of({100, 120, 100, 255}, maps), PixelReject::kSaturated);
  EXPECT_EQ(verdict_of({100, 180, 100, 99}, maps), PixelReject::kNoisy);
  EXPECT_EQ(verdict_of({200, 255, 80, 80}, maps), PixelReject::kNone);
  EXPECT_TRUE(std::isnan(maps.code_dn[0]));  // no code here, but phase
  EXPECT_EQ(verdict_of({200, 0, 80, 80}, maps), PixelReject::kNone);
}

/// Spans of a strip's whole fringes.
std::vector<CellSpan> whole_spans(const Strip& s) {
  std::vector<CellSpan> spans;
  for (int v = 0; v < s.height; ++v) {
    for (int u = 0; u < s.width; ++u) {
      const int cell = static_cast<int>(std::floor(s.phase_rad[static_cast<std::size_t>(u)] / kPi));
      if (u == 0 || spans.back().cell != cell) spans.push_back({v, u, u, cell, u > 0});
      spans.back().end = u + 1;
      if (u + 1 == s.width) spans.back().whole = false;
    }
  }
  return spans;
}

TEST(ThirdHarmonic, is_found_and_undone) {
  for (const double harmonic : {0.01, -0.02, 0.05}) {
    StripOptions o;
    o.harmonic = harmonic;
    o.fringes = 33.7;
    const Strip s = make_strip(1000, 20, o);
    PhaseMaps maps;
    compute_micro_phase(s.view(), constant_noise(1), {}, maps);
    EXPECT_GT(worst_error(maps, s), 0.95 * std::abs(harmonic));  // the control: there is something to undo
    const auto spans = whole_spans(s);
    const ThirdHarmonic third = estimate_third_harmonic(spans, maps);
    EXPECT_GT(third.pixels, 0.9 * 1000 * 20);
    EXPECT_NEAR(static_cast<double>(third.a1_rad), -harmonic, 3e-4 + 0.02 * std::abs(harmonic));
    Map<std::int16_t> wraps;
    place_spans(spans, {}, maps.phase_rad.width(), maps.phase_rad.height(), wraps);
    correct_third_harmonic(wraps, third.a1_rad, maps);
    EXPECT_LT(worst_error(maps, s), 3e-4 + 2 * harmonic * harmonic) << harmonic;  // first order
  }
}

TEST(ThirdHarmonic, invents_nothing_on_a_slanted_surface) {
  const Strip s = make_strip(1000, 20, {});
  PhaseMaps maps;
  compute_micro_phase(s.view(), constant_noise(1), {}, maps);
  for (std::size_t i = 0; i < maps.phase_rad.size(); ++i) {
    // Density of phase that falls by a third within each fringe.
    const double share = std::fmod(s.phase_rad[i], 2 * kPi) / (2 * kPi),
                 bent = 2 * kPi * (share + 0.15 * share * (share - 1));
    maps.cosine_dn[i] = static_cast<float>(20000 * std::cos(bent));
    maps.sine_dn[i] = static_cast<float>(20000 * std::sin(bent));
  }
  std::vector<CellSpan> spans;
  for (int v = 0; v < 20; ++v) {
    for (int f = 0; f < 40; ++f) {
      spans.push_back({v, 25 * f, 25 * f + 12, 2 * f, true});
      spans.push_back({v, 25 * f + 12, 25 * f + 25, 2 * f + 1, true});
    }
  }
  EXPECT_LT(std::abs(estimate_third_harmonic(spans, maps).a1_rad), 0.01F);
  double half = 0;  // the control: over half fringes alone the same surface would bias it
  for (int i = 0; i < 12; ++i) {
    half += std::cos(3 * static_cast<double>(std::atan2(maps.sine_dn[static_cast<std::size_t>(i)],
                                                        maps.cosine_dn[static_cast<std::size_t>(i)])));
  }
  EXPECT_GT(std::abs(2.0 / 3 * half / 12), 0.015);
}

TEST(MicroPhase, motion_delays_and_ripples_as_the_header_says) {
  StripOptions o;
  o.motion_rad = 0.01;
  const Strip s = make_strip(1000, 1, o);
  PhaseMaps maps;
  compute_micro_phase(s.view(), constant_noise(1), {}, maps);
  double mean = 0, squares = 0;
  for (std::size_t i = 0; i < 1000; ++i) mean += error_of(maps.phase_rad[i], s.phase_rad[i]) / 1000;
  for (std::size_t i = 0; i < 1000; ++i)
    squares += std::pow(error_of(maps.phase_rad[i], s.phase_rad[i]) - mean, 2) / 1000;
  EXPECT_NEAR(mean / 0.01, 1.0 / 6, 0.01);
  EXPECT_NEAR(std::sqrt(2 * squares) / 0.01, 0.882, 0.01);
}

}  // namespace
}  // namespace enamel::pipeline
