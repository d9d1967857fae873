// Bright surfaces: pixels whose crest is clipped in one frame are solved from the other three, or rejected.
#include "pipeline/decode/mode_t/saturated.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

const calib::Rig& rig() {
  static const calib::Rig kRig = test::cropped_rig(640, 120);
  return kRig;
}

const BurstDecoder& decoder() {
  static const BurstDecoder kDecoder = BurstDecoder::make(rig()).value();
  return kDecoder;
}

/// Crests reach 265 DN: each frame is clipped over a sixth of every fringe, one frame or another over half of it.
test::SyntheticBurst bright(double motion_rad) {
  test::SceneOptions o;
  o.noise = true;
  o.mean_dn = 150;
  o.modulation_dn = 110;
  o.motion_rad = motion_rad;
  return test::render(
      rig(), [](int u, int v) { return 47 + 0.002 * u + 0.004 * v; }, o);
}

struct Clipped {
  std::size_t all = 0, measured = 0, wrong = 0;
  double mean_over_sigma = 0, rms_over_sigma = 0;
};

/// Pixels with frame `frame` clipped and no other.
Clipped judge(const test::SyntheticBurst& scene, const DecodedBurst& out, std::size_t frame) {
  Clipped c;
  for (std::size_t i = 0; i < scene.depth_mm.size(); ++i) {
    bool only = true;
    for (std::size_t k = 0; k < 4; ++k) only = only && (scene.frames.frames[k][i] >= 248) == (k == frame);
    if (!only) continue;
    ++c.all;
    if (out.reject[i] != PixelReject::kNone) continue;
    ++c.measured;
    const double e = static_cast<double>(out.patch.depth_mm[i]) - scene.depth_mm[i];
    c.wrong += std::abs(e) > 0.5 ? 1U : 0U;
    const double s = e / static_cast<double>(out.patch.sigma_mm[i]);
    c.mean_over_sigma += s;
    c.rms_over_sigma += s * s;
  }
  c.mean_over_sigma /= static_cast<double>(c.measured);
  c.rms_over_sigma = std::sqrt(c.rms_over_sigma / static_cast<double>(c.measured));
  return c;
}

TEST(Saturated, one_clipped_frame_costs_no_more_than_the_code_demands) {
  const auto scene = bright(0);
  const DecodedBurst out = decoder().decode(scene.frames.view());
  ASSERT_EQ(out.verdict, BurstVerdict::kAccepted);
  // Frame 1 without frame 3 means b = +1: all that have an order, of which so bright a scene leaves fewer. Frames 0 and
  // 2 need b = +1 on both sides of their crest, which 4 of the code's 16 pairs of cells have.
  const std::array<double, 3> least = {0.15, 0.65, 0.15};
  for (std::size_t k = 0; k < 3; ++k) {
    const Clipped c = judge(scene, out, k);
    ASSERT_GT(c.all, 3000U) << k;
    EXPECT_GT(static_cast<double>(c.measured), least[k] * static_cast<double>(c.all)) << k;
    EXPECT_EQ(c.wrong, 0U) << k;
    EXPECT_NEAR(c.mean_over_sigma, 0, 0.1) << k;
    EXPECT_NEAR(c.rms_over_sigma, 1, 0.1) << k;
  }
}

TEST(Saturated, motion_is_undone_for_the_frames_that_were_used) {
  const auto scene = bright(0.12);
  const DecodedBurst out = decoder().decode(scene.frames.view());
  DecodeConfig raw;
  raw.correct_closure = false;
  const DecodedBurst control = BurstDecoder::make(rig(), raw).value().decode(scene.frames.view());
  ASSERT_EQ(out.verdict, BurstVerdict::kAccepted);
  double worst = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Clipped c = judge(scene, out, k);
    EXPECT_EQ(c.wrong, 0U) << k;
    EXPECT_NEAR(c.mean_over_sigma, 0, 0.3) << k;
    worst = std::max(worst, std::abs(judge(scene, control, k).mean_over_sigma));
  }
  EXPECT_GT(worst, 1.5);
}

TEST(Saturated, solution_is_exact_for_each_missing_frame) {
  const NoiseModel noise = noise_from_rig(*rig().noise, 16);
  const double mean = 40000, amplitude = 30000;
  const std::array<double, 3> crest = {0, -std::numbers::pi / 2, std::numbers::pi};
  for (std::size_t missing = 0; missing < 3; ++missing) {
    for (const double off : {-0.4, 0.0, 0.4}) {
      const double phi = crest[missing] + off;
      const std::array<double, 4> dn = {mean + amplitude * std::cos(phi), mean - amplitude * std::sin(phi),
                                        mean - amplitude * std::cos(phi), mean + amplitude * std::sin(phi)};
      std::array<std::vector<std::uint8_t>, 4> bytes;
      BurstView view{1, 1, 16, {}};
      for (std::size_t k = 0; k < 4; ++k) {
        const auto value = static_cast<unsigned>(std::min(std::lround(dn[k]), 65535L));
        bytes[k] = {static_cast<std::uint8_t>(value & 255U), static_cast<std::uint8_t>(value >> 8U)};
        view.frames[k] = bytes[k];
      }
      PhaseMaps maps;
      std::vector<SaturatedPixel> pixels;
      compute_phase(view, noise, {}, maps);
      ASSERT_EQ(maps.reject[0], PixelReject::kSaturated);
      solve_saturated(view, noise, {}, maps, pixels);
      ASSERT_EQ(pixels.size(), 1U);
      EXPECT_EQ(pixels[0].missing, missing);
      EXPECT_NEAR(std::remainder(static_cast<double>(maps.phase_rad[0]) - phi, 2 * std::numbers::pi), 0, 1e-4);
      EXPECT_NEAR(static_cast<double>(maps.mean_dn[0]), mean, 2);
    }
  }
}

TEST(Saturated, two_clipped_frames_leave_nothing_to_solve) {
  test::FrameSet f{1, 1, {}};
  f.frames = {{{255}, {255}, {40}, {120}}};
  const NoiseModel noise = noise_from_rig(*rig().noise, 8);
  PhaseMaps maps;
  std::vector<SaturatedPixel> pixels;
  compute_phase(f.view(), noise, {}, maps);
  solve_saturated(f.view(), noise, {}, maps, pixels);
  EXPECT_TRUE(pixels.empty());
  EXPECT_EQ(maps.reject[0], PixelReject::kSaturated);
}

}  // namespace
}  // namespace enamel::pipeline
