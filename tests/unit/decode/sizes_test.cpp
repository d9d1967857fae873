// Frames of any size and of 8 to 16 bits.
#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

struct Size {
  int width, height;
};

class Sizes : public testing::TestWithParam<Size> {};

TEST_P(Sizes, every_pixel_is_accounted_for) {
  const calib::Rig rig = test::cropped_rig(GetParam().width, GetParam().height);
  DecodeConfig config;
  config.light.min_points = 1;
  const auto scene = test::render(rig, test::flat(48), test::noisy());
  const DecodedBurst b = BurstDecoder::make(rig, config).value().decode(scene.frames.view());
  std::size_t counted = 0;
  for (const std::size_t n : b.counts) counted += n;
  EXPECT_EQ(counted, scene.depth_mm.size());
  for (std::size_t i = 0; i < b.reject.size(); ++i) {
    if (b.reject[i] != PixelReject::kNone) continue;
    EXPECT_NEAR(b.patch.depth_mm[i], 48, 0.5);
  }
}
INSTANTIATE_TEST_SUITE_P(Odd, Sizes,
                         testing::Values(Size{1, 1}, Size{1, 200}, Size{300, 1}, Size{2, 2}, Size{3, 301}, Size{301, 3},
                                         Size{7, 5}, Size{317, 97}));

class Depths : public testing::TestWithParam<int> {};

TEST_P(Depths, finer_steps_cost_nothing_and_sigma_knows_them) {
  calib::Rig rig = test::cropped_rig(317, 121);
  rig.noise->bits = 8;  // whose DN the sensor's values are in; frames may have more
  test::SceneOptions o = test::noisy();
  o.bits = GetParam();
  const auto scene = test::render(rig, test::flat(48), o);
  const DecodedBurst b = BurstDecoder::make(rig).value().decode(scene.frames.view());
  ASSERT_EQ(b.verdict, BurstVerdict::kAccepted);
  EXPECT_GT(b.patch.valid_px, 0.97 * static_cast<double>(scene.depth_mm.size()));
  double sum = 0;
  for (std::size_t i = 0; i < b.reject.size(); ++i) {
    if (b.reject[i] != PixelReject::kNone) continue;
    const double e = static_cast<double>(b.patch.depth_mm[i] - 48) / static_cast<double>(b.patch.sigma_mm[i]);
    sum += e * e;
  }
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(b.patch.valid_px)), 1, 0.05);
}
INSTANTIATE_TEST_SUITE_P(Bits, Depths, testing::Values(8, 10, 12, 16));

TEST(DepthsOfRig, frames_of_ten_bits_are_measured_in_the_rigs_own_levels) {
  calib::Rig ten = test::cropped_rig(317, 121);
  ten.noise->bits = 10;
  ten.noise->gain_e_per_dn *= 255.0 / 1023;
  ten.noise->black_dn *= 1023.0 / 255;
  test::SceneOptions o = test::noisy();
  o.bits = 10;
  const auto scene = test::render(test::cropped_rig(317, 121), test::flat(48), o);
  const DecodedBurst a = BurstDecoder::make(ten).value().decode(scene.frames.view());
  const DecodedBurst b = BurstDecoder::make(test::cropped_rig(317, 121)).value().decode(scene.frames.view());
  ASSERT_EQ(a.verdict, BurstVerdict::kAccepted);
  EXPECT_EQ(a.patch.valid_px, b.patch.valid_px);
  for (std::size_t i = 0; i < a.reject.size(); i += 97) {
    if (a.reject[i] != PixelReject::kNone) continue;
    EXPECT_NEAR(a.patch.sigma_mm[i] / b.patch.sigma_mm[i], 1, 1e-3);
  }
}

}  // namespace
}  // namespace enamel::pipeline
