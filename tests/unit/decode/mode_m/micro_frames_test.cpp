// Bursts that mode M must refuse: frames in a wrong order, and those of other pattern sets.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/unit/decode/mode_m/micro_scene.hpp"

namespace enamel::pipeline {
namespace {

using test::decoder;
using test::Depth;
using test::figures;
using test::kSlant;
using test::kStairs;
using test::noisy;
using test::wide_rig;

/// Every order of the four frames but the right one.
std::vector<std::array<std::size_t, 4>> permutations() {
  std::vector<std::array<std::size_t, 4>> out;
  std::array<std::size_t, 4> order = {0, 1, 2, 3};
  while (std::next_permutation(order.begin(), order.end())) out.push_back(order);
  return out;
}

BurstView permuted(const test::SyntheticBurst& scene, const std::array<std::size_t, 4>& order) {
  BurstView view = scene.frames.view();
  for (std::size_t k = 0; k < 4; ++k) view.frames[k] = scene.frames.frames[order[k]];
  return view;
}

class MicroPermutation : public testing::TestWithParam<std::array<std::size_t, 4>> {};

TEST_P(MicroPermutation, is_detected) {
  for (const double modulation : {12.0, 80.0}) {
    for (const double motion : {0.0, 0.2}) {
      for (const Depth& depth : {kSlant, kStairs}) {
        test::SceneOptions o = noisy(modulation);
        o.motion_rad = motion;
        const auto scene = test::render(wide_rig(), depth, o);
        ASSERT_TRUE(decoder().decode(scene.frames.view()).accepted());  // the control: in order it is accepted
        const DecodedBurst b = decoder().decode(permuted(scene, GetParam()));
        EXPECT_EQ(b.verdict, BurstVerdict::kPatternMismatch) << modulation << " " << motion << " " << figures(b);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, MicroPermutation, testing::ValuesIn(permutations()), [](const auto& p) {
  std::string name;
  for (const std::size_t k : p.param) name += std::to_string(k);
  return name;
});

/// In principle: a cyclic permutation shifts phi by a third of a fringe, which turns the code by (L + 1)/3 steps
/// between orders. At L = 5 these are two whole steps, so the frames are those of a surface 5/3 fringes off, and only
/// where such a surface leaves the depth range or the projector's frame can anybody notice. At L = 6 they are 2 1/3.
TEST(MicroFrames, cyclic_permutation_is_another_surface_where_the_ratio_plus_one_is_a_multiple_of_three) {
  const calib::Rig rig = test::micro_rig(400, 120, 5);
  const BurstDecoder five = BurstDecoder::make(rig).value();
  const auto scene = test::render(rig, test::flat(46), noisy());
  ASSERT_TRUE(five.decode(scene.frames.view()).accepted());
  for (const auto& order : {std::array<std::size_t, 4>{2, 1, 3, 0}, std::array<std::size_t, 4>{3, 1, 0, 2}}) {
    const DecodedBurst b = five.decode(permuted(scene, order));
    EXPECT_GT(b.diagnostics.code_agreement, 0.95);
    EXPECT_LT(std::abs(b.diagnostics.code_turn_rad), 0.02);
    for (std::size_t i = 0; i < b.patch.depth_mm.size(); ++i)
      ASSERT_FALSE(std::abs(b.patch.depth_mm[i] - 46) < 3);  // elsewhere, or NaN
    EXPECT_FALSE(decoder().decode(permuted(test::render(wide_rig(), test::flat(46), noisy()), order)).accepted());
  }
}

TEST(MicroFrames, foreign_bursts_are_refused) {
  for (const Depth& depth : {kSlant, kStairs, test::flat(48)}) {
    const calib::Rig polarity = test::cropped_rig(400, 120);
    calib::Rig plain = polarity;
    plain.patterns.polarity_code.clear();
    for (const calib::Rig& other :
         {polarity, plain, test::micro_rig(400, 120, 5), test::micro_rig(400, 120, 7), test::micro_rig(400, 120, 12)}) {
      const DecodedBurst b = decoder().decode(test::render(other, depth, noisy()).frames.view());
      EXPECT_FALSE(b.accepted()) << other.patterns.code_ratio << " " << figures(b);
    }
    const BurstDecoder by_polarity = BurstDecoder::make(polarity).value();
    const DecodedBurst b = by_polarity.decode(test::render(wide_rig(), depth, noisy()).frames.view());
    EXPECT_EQ(b.verdict, BurstVerdict::kPatternMismatch) << figures(b);
  }
}

}  // namespace
}  // namespace enamel::pipeline
