// Pixels that three frames measure too badly at some phases, and four well enough at all.
#include "pipeline/decode/mode_t/faint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kWidth = 160, kHeight = 120, kPixels = kWidth * kHeight;

/// A plane whose phase four frames with b = +1 measure to sigma_rad.
test::SyntheticBurst plane(double sigma_rad) {
  const calib::Rig rig = test::cropped_rig(kWidth, kHeight);
  test::SceneOptions o = test::with_noise();
  const double e = o.mean_dn * rig.noise->gain_e_per_dn + rig.noise->read_noise_e * rig.noise->read_noise_e;
  const double frame_dn = std::sqrt(e / (rig.noise->gain_e_per_dn * rig.noise->gain_e_per_dn) + 1.0 / 12);
  o.modulation_dn = std::sqrt(0.5) * frame_dn / sigma_rad;
  return test::render(rig, test::flat(48), o);
}

DecodedBurst decoded(const test::SyntheticBurst& burst) {
  DecodeConfig config;
  config.translucency.correct = false;  // so little contrast under so much light is a tooth's, with its own uncertainty
  return BurstDecoder::make(test::cropped_rig(kWidth, kHeight), config).value().decode(burst.frames.view());
}

std::size_t count(const DecodedBurst& d, PixelReject why) { return d.counts[static_cast<std::size_t>(why)]; }

TEST(Faint, a_surface_that_four_frames_measure_has_no_stripes) {
  const test::SyntheticBurst burst = plane(0.7 * static_cast<double>(PhaseConfig{}.max_sigma_rad));
  const DecodedBurst d = decoded(burst);
  ASSERT_TRUE(d.accepted());
  EXPECT_LT(count(d, PixelReject::kNoisy), std::size_t{kPixels / 12});
  EXPECT_GT(count(d, PixelReject::kNone), std::size_t{kPixels * 9 / 10});
}

TEST(Faint, its_sigma_is_the_error_that_it_has) {
  const test::SyntheticBurst burst = plane(0.7 * static_cast<double>(PhaseConfig{}.max_sigma_rad));
  const DecodedBurst d = decoded(burst);
  double squares = 0;
  for (std::size_t i = 0; i < d.reject.size(); ++i) {
    if (d.reject[i] != PixelReject::kNone) continue;
    squares += std::pow(
        (static_cast<double>(d.patch.depth_mm[i]) - burst.depth_mm[i]) / static_cast<double>(d.patch.sigma_mm[i]), 2);
  }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(count(d, PixelReject::kNone))), 1, 0.08);
}

TEST(Faint, a_surface_that_four_frames_do_not_measure_is_left_out) {
  EXPECT_GT(count(decoded(plane(2 * static_cast<double>(PhaseConfig{}.max_sigma_rad))), PixelReject::kNoisy),
            std::size_t{kPixels * 95 / 100});
}

TEST(Faint, without_a_fourth_frame_three_have_to_do) {
  PhaseMaps maps;
  maps.resize(2, 1);
  for (const std::size_t i : {0U, 1U}) {
    maps.cosine_dn[i] = 10, maps.sine_dn[i] = 0;
    maps.sigma_rad[i] = 1.5F * PhaseConfig{}.max_sigma_rad;
    maps.reject[i] = PixelReject::kNoisy;
  }
  maps.code_dn[0] = 0, maps.code_dn[1] = std::numeric_limits<float>::quiet_NaN();
  admit_faint({}, maps);
  EXPECT_EQ(maps.reject[0], PixelReject::kNone);
  EXPECT_EQ(maps.reject[1], PixelReject::kNoisy);
}

}  // namespace
}  // namespace enamel::pipeline
