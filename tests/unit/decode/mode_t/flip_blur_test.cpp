// Frame 3 beside the flips of the polarity code: the blur that the burst shows, and what is made of it.
#include "pipeline/decode/mode_t/flip_blur.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr double kPi = std::numbers::pi;

struct Decoded {
  DecodedBurst burst;
  test::SyntheticBurst truth;

  /// Phase less the truth, rad, at pixel i.
  [[nodiscard]] double error(std::size_t i) const {
    const double d = static_cast<double>(burst.phase_rad[i]) - truth.phase_rad[i];
    return d - 2 * kPi * std::round(d / (2 * kPi));
  }
  /// Largest mean error of 24 bins of the phase, mrad: what prints itself on the surface.
  [[nodiscard]] double ripple_mrad() const {
    std::vector<double> sum(24), count(24);
    for (std::size_t i = 0; i < truth.phase_rad.size(); ++i) {
      if (burst.reject[i] != PixelReject::kNone) continue;
      const double turns = truth.phase_rad[i] / (2 * kPi);
      const auto bin = static_cast<std::size_t>(24 * (turns - std::floor(turns)));
      sum[bin] += error(i), count[bin] += 1;
    }
    double worst = 0;
    for (std::size_t k = 0; k < sum.size(); ++k) worst = std::max(worst, std::abs(sum[k] / count[k]));
    return 1000 * worst;
  }
  [[nodiscard]] double mean_variance() const {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < truth.phase_rad.size(); ++i) {
      if (burst.reject[i] != PixelReject::kNone) continue;
      sum += std::pow(error(i), 2), count += 1;
    }
    return sum / count;
  }
};

Decoded decode(test::SceneOptions scene, const FlipBlurConfig& flips = {}) {
  const calib::Rig rig = test::cropped_rig(kWidth, kHeight);
  scene.light = test::lens_light(rig, test::flat(47));
  DecodeConfig config;
  config.four_step.flips = flips;
  Decoded out{{}, test::render(rig, test::flat(47), scene)};
  out.burst = BurstDecoder::make(rig, config).value().decode(out.truth.frames.view());
  EXPECT_TRUE(out.burst.accepted()) << name_of(out.burst.verdict);
  return out;
}

test::SceneOptions blurred(double sigma_rad, double motion_rad, bool noise) {
  test::SceneOptions o = test::noisy();
  o.noise = noise;
  o.bits = noise ? 8 : 12;
  o.blur_fringe = sigma_rad / (2 * kPi);
  o.motion_rad = motion_rad;
  return o;
}

FlipBlurConfig unused() { return {.drop_sigmas = 100, .full_sigmas = 101}; }
/// Frame 3 taken as sharp: what the check below must see.
FlipBlurConfig trusting() {
  return {.drop_sigmas = 0.0F, .full_sigmas = 0.01F, .least_sigma_rad = 0.01F, .largest_sigma_rad = 0.01F};
}

TEST(FlipBlur, is_found_still_and_moving) {
  for (const double sigma : {0.2, 0.3, 0.4}) {
    for (const double motion : {0.0, 0.1, -0.1}) {
      const Decoded d = decode(blurred(sigma, motion, true));
      EXPECT_NEAR(static_cast<double>(d.burst.diagnostics.flip_blur_rad), sigma, 0.1 * sigma) << motion;
    }
  }
}

TEST(FlipBlur, leaves_no_print_beside_the_flips) {
  for (const double sigma : {0.2, 0.4}) {
    for (const double motion : {0.0, 0.1}) {
      const double without = decode(blurred(sigma, motion, false), unused()).ripple_mrad();
      const double with = decode(blurred(sigma, motion, false)).ripple_mrad();
      EXPECT_LE(with, without + 2) << sigma << " " << motion;
      EXPECT_GE(decode(blurred(sigma, motion, false), trusting()).ripple_mrad(), without + 5) << "the control";
    }
  }
}

TEST(FlipBlur, frame_3_nearer_to_the_flips_means_less_noise) {
  const double without = decode(blurred(0.2, 0, true), unused()).mean_variance();
  const Decoded d = decode(blurred(0.2, 0, true));
  EXPECT_LE(d.mean_variance(), 0.93 * without);
  // What sigma_mm says is still what is scattered.
  double predicted = 0, seen = 0;
  for (std::size_t i = 0; i < d.truth.depth_mm.size(); ++i) {
    if (d.burst.reject[i] != PixelReject::kNone) continue;
    predicted += std::pow(static_cast<double>(d.burst.patch.sigma_mm[i]), 2);
    seen += std::pow(static_cast<double>(d.burst.patch.depth_mm[i]) - d.truth.depth_mm[i], 2);
  }
  EXPECT_NEAR(std::sqrt(seen / predicted), 1, 0.03);
}

}  // namespace
}  // namespace enamel::pipeline
