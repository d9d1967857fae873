// Scenes that break phase unwrapping. What counts: no pixel with a wrong fringe order; what cannot be known is
// rejected.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pipeline/algo/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::algo {
namespace {

struct Outcome {
  std::size_t valid = 0, wrong = 0, lit = 0;
  DecodedBurst burst;
};

Outcome decode(const calib::Rig& rig, const std::function<double(int, int)>& depth, const test::SceneOptions& o) {
  const auto scene = test::render(rig, depth, o);
  const BurstDecoder decoder = BurstDecoder::make(rig).value();
  Outcome out;
  out.burst = decoder.decode(scene.frames.view());
  for (int v = 0; v < rig.camera.height; ++v) {
    for (int u = 0; u < rig.camera.width; ++u) {
      out.lit += o.light(u, v) > 0 ? 1U : 0U;
      const auto z = static_cast<double>(out.burst.patch.depth_mm(u, v));
      if (std::isnan(z)) continue;
      ++out.valid;
      out.wrong += std::abs(z - scene.depth_mm(u, v)) > 1.0 ? 1U : 0U;  // a wrong order is 3.5 mm off
    }
  }
  return out;
}

test::SceneOptions noisy() {
  test::SceneOptions o;
  o.noise = true;
  return o;
}

TEST(Unwrap, plane_is_whole) {
  const Outcome r = decode(test::cropped_rig(320, 120), test::flat(48), noisy());
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GE(static_cast<double>(r.valid), 0.99 * static_cast<double>(r.lit));
}

TEST(Unwrap, weak_modulation_stays_right) {
  test::SceneOptions o = noisy();
  o.mean_dn = 60;
  o.modulation_dn = 13;  // sigma of three frames up to 0.12 rad, the mask's limit is 0.15
  const Outcome r = decode(test::cropped_rig(320, 120), test::flat(50), o);
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GE(static_cast<double>(r.valid), 0.9 * static_cast<double>(r.lit));
}

TEST(Unwrap, gaps_between_teeth_do_not_tear_the_far_side_off) {
  for (const double deep_mm : {0.3, 1.0, 2.0}) {
    const Outcome r = decode(
        test::cropped_rig(400, 120), [=](int u, int) { return u > 190 && u < 215 ? 47 + deep_mm : 47.0; }, noisy());
    EXPECT_EQ(r.wrong, 0U) << deep_mm;
    EXPECT_GE(static_cast<double>(r.valid), 0.85 * static_cast<double>(r.lit)) << deep_mm;
  }
}

TEST(Unwrap, jump_of_exactly_one_fringe_along_the_fringes_is_found_by_the_code) {
  const calib::Rig rig = test::cropped_rig(320, 160);
  const double jump = test::fringe_jump_mm(rig, 50);
  const Outcome r = decode(
      rig, [&](int, int v) { return v < 80 ? 50.0 : 50 - jump; }, noisy());
  EXPECT_LE(r.wrong, 320U);  // at most the row of the jump itself
  EXPECT_GE(static_cast<double>(r.valid), 0.9 * static_cast<double>(r.lit));
}

TEST(Unwrap, jump_of_exactly_one_fringe_across_the_fringes_is_found_by_the_code) {
  const calib::Rig rig = test::cropped_rig(400, 100);
  const double jump = test::fringe_jump_mm(rig, 50);
  const Outcome r = decode(
      rig, [&](int u, int) { return u < 200 ? 50.0 : 50 - jump; }, noisy());
  EXPECT_LE(static_cast<double>(r.wrong), 0.01 * static_cast<double>(r.lit));
  EXPECT_GE(static_cast<double>(r.valid), 0.8 * static_cast<double>(r.lit));
}

TEST(Unwrap, isolated_patch_with_enough_code_is_placed) {
  test::SceneOptions o = noisy();
  o.light = [](int u, int v) { return u > 100 && u < 200 && v > 40 && v < 80 ? 1.0 : 0.0; };
  const Outcome r = decode(test::cropped_rig(320, 120), test::flat(44), o);
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GE(static_cast<double>(r.valid), 0.8 * static_cast<double>(r.lit));
}

TEST(Unwrap, patch_of_half_a_fringe_is_rejected_as_undecided_not_guessed) {
  test::SceneOptions o = noisy();
  o.light = [](int u, int v) { return (u < 200 || (u > 250 && u < 261 && v > 50 && v < 61)) ? 1.0 : 0.0; };
  const Outcome r = decode(test::cropped_rig(320, 120), test::flat(44), o);
  EXPECT_EQ(r.wrong, 0U);
  for (int v = 51; v < 61; ++v)
    for (int u = 251; u < 261; ++u) ASSERT_TRUE(std::isnan(r.burst.patch.depth_mm(u, v))) << u << "," << v;
  EXPECT_GT(r.burst.counts[static_cast<std::size_t>(PixelReject::kRelative)], 20U);
}

TEST(Unwrap, surface_that_leaves_the_depth_range_is_not_folded_back_into_it) {
  const Outcome r = decode(
      test::cropped_rig(400, 100), [](int u, int) { return 52 + 0.02 * u; }, noisy());
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GT(r.burst.counts[static_cast<std::size_t>(PixelReject::kOutOfRange)], 5000U);
}

TEST(Unwrap, without_polarity_code_nothing_is_placed) {
  calib::Rig rig = test::cropped_rig(320, 120);
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.polarity_code.clear();
  const Outcome r = decode(rig, test::flat(48), noisy());
  EXPECT_EQ(r.burst.verdict, BurstVerdict::kNoCode);
  EXPECT_EQ(r.valid, 0U);
}

TEST(Unwrap, plain_frames_are_placed_when_the_depth_range_allows_one_order_only) {
  calib::Rig rig = test::cropped_rig(320, 120);
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.polarity_code.clear();
  rig.depth_range = calib::DepthRange{47.5, 48.5};
  const Outcome r = decode(rig, test::flat(48), noisy());
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GE(static_cast<double>(r.valid), 0.95 * static_cast<double>(r.lit));
}

}  // namespace
}  // namespace enamel::algo
