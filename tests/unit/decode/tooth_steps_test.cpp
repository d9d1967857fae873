// The scenes that fringe counting is judged on, and the judge, must themselves be sound.
#include "tests/support/tooth_steps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/support/order_score.hpp"

namespace enamel::test {
namespace {

constexpr int kWidth = 300, kHeight = 220;

/// A burst that was decoded without a fault.
pipeline::DecodedBurst perfect(const SyntheticBurst& truth) {
  pipeline::DecodedBurst b;
  b.verdict = pipeline::BurstVerdict::kAccepted;
  b.phase_rad = Map<float>(kWidth, kHeight);
  b.order = Map<std::uint8_t>(kWidth, kHeight);
  b.reject = Map<pipeline::PixelReject>(kWidth, kHeight, pipeline::PixelReject::kNone);
  b.patch.depth_mm = b.patch.sigma_mm = Map<float>(kWidth, kHeight, 0.01F);
  for (std::size_t i = 0; i < b.order.size(); ++i) {
    b.order[i] = static_cast<std::uint8_t>(truth.phase_rad[i] / (2 * std::numbers::pi));
    b.phase_rad[i] = static_cast<float>(std::remainder(truth.phase_rad[i], 2 * std::numbers::pi));
    b.patch.depth_mm[i] = static_cast<float>(truth.depth_mm[i]);
  }
  return b;
}

struct Scene {
  calib::Rig rig = cropped_rig(kWidth, kHeight);
  ToothSteps steps = make_tooth_steps(rig, 5);
  SyntheticBurst burst = render(
      rig, [this](int u, int v) { return steps.depth_mm(u, v); }, steps.options(1));
};

TEST(ToothSteps, hold_what_they_promise) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const calib::Rig rig = cropped_rig(kWidth, kHeight);
    const ToothSteps s = make_tooth_steps(rig, seed);
    std::size_t lit = 0, seamless = 0;
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u + 1 < kWidth; ++u) {
        ASSERT_GT(s.depth_mm(u, v), 40);
        ASSERT_LT(s.depth_mm(u, v), 56);
        ASSERT_GE(s.contrast(u, v), 0.1);
        lit += s.light(u, v) > 0 ? 1U : 0U;
        // A jump of 3 mm or so that is lit on both sides.
        const double jump = std::abs(s.depth_mm(u + 1, v) - s.depth_mm(u, v));
        seamless += jump > 3 && jump < 4.2 && s.light(u, v) > 0 && s.light(u + 1, v) > 0 ? 1U : 0U;
        if (jump > 0.3 && v < kHeight - 60) {
          ASSERT_NE(s.near_jump(u, v), 0);
        }
      }
    }
    EXPECT_GT(lit, kWidth * kHeight / 3U) << seed;
    if (seed == 5) {
      EXPECT_GT(seamless, 0U);
    }
  }
}

TEST(ToothSteps, phase_does_not_show_the_jump_of_one_fringe) {
  const Scene s;
  std::size_t jumps = 0;
  for (int v = 0; v < kHeight - 60; ++v) {
    for (int u = 0; u + 1 < kWidth; ++u) {
      const double step = s.burst.phase_rad(u + 1, v) - s.burst.phase_rad(u, v),
                   turns = std::round(step / (2 * std::numbers::pi));
      if (std::abs(turns) != 1 || std::abs(step - turns * 2 * std::numbers::pi) > 0.35) continue;
      ++jumps;
    }
  }
  EXPECT_GT(jumps, 50U);
}

TEST(OrderScore, counts_what_is_wrong_and_nothing_else) {
  const Scene s;
  pipeline::DecodedBurst b = perfect(s.burst);
  const OrderCounts right = score_orders(b, s.burst, s.steps.light, s.steps.near_jump);
  EXPECT_EQ(right.wrong, 0U);
  EXPECT_EQ(right.accepted, right.lit);
  EXPECT_LT(right.rms_um(), 0.01);
  // 12 x 10 px of lit surface a fringe off: a region above 100 px.
  std::size_t moved = 0;
  for (int v = 0; v < 10; ++v)
    for (int u = 0; u < 12; ++u) ++b.order(u, v), moved += s.steps.light(u, v) > 0 ? 1U : 0U;
  const OrderCounts wrong = score_orders(b, s.burst, s.steps.light, s.steps.near_jump);
  EXPECT_EQ(wrong.wrong, moved);
  EXPECT_EQ(wrong.bursts_with_large_wrong, moved > 100 ? 1U : 0U);
  b.reject(50, 5) = pipeline::PixelReject::kRelative, b.reject(51, 5) = pipeline::PixelReject::kNoisy;
  b.reject(52, 5) = pipeline::PixelReject::kEdge;
  const OrderCounts left = score_orders(b, s.burst, s.steps.light, s.steps.near_jump);
  EXPECT_EQ(left.undecided + left.masked + left.edge, 3U);
}

TEST(OrderScore, rejected_burst_decides_nothing) {
  const Scene s;
  pipeline::DecodedBurst b = perfect(s.burst);
  b.verdict = pipeline::BurstVerdict::kNoCode;
  const OrderCounts c = score_orders(b, s.burst, s.steps.light, s.steps.near_jump);
  EXPECT_EQ(c.accepted, 0U);
  EXPECT_EQ(c.undecided, c.lit);
}

TEST(OrderScore, regions_hang_together_by_their_sides) {
  Map<std::uint8_t> m(4, 3);
  m(0, 0) = m(1, 0) = m(2, 1) = m(3, 1) = m(3, 2) = 1;
  EXPECT_EQ(largest_region(m), 3U);  // the corner between (1, 0) and (2, 1) does not count
}

/// Modulation behind the projector's blur is that of a Gaussian; the camera's point spread takes its own share.
TEST(Synthetic, blur_takes_the_modulation_of_a_gaussian) {
  const calib::Rig rig = cropped_rig(kWidth, 8);
  const auto swing = [&](const SceneOptions& o) {
    const SyntheticBurst burst = render(rig, flat(48), o);
    const auto& f = burst.frames.frames[0];
    const auto [low, high] = std::minmax_element(f.begin() + kWidth, f.end() - kWidth);
    return (*high - *low) / (2 * o.modulation_dn);
  };
  EXPECT_NEAR(swing({}), 1, 0.02);
  EXPECT_NEAR(swing({.blur_fringe = 0.1}), std::exp(-0.5 * std::pow(0.2 * std::numbers::pi, 2)), 0.02);
  EXPECT_NEAR(swing({.blur_fringe = 0.2}), std::exp(-0.5 * std::pow(0.4 * std::numbers::pi, 2)), 0.02);
  EXPECT_NEAR(swing({.psf_px = 4}), std::exp(-0.5 * std::pow(2 * std::numbers::pi * 4 / 26.6, 2)), 0.04);
}

/// What becomes of some rows of teeth before a rig of 400 x 300 px.
OrderCounts decode_teeth(const calib::Rig& rig, const pipeline::DecodeConfig& config,
                         const std::vector<std::uint64_t>& seeds) {
  const calib::Rig scenes = cropped_rig(400, 300);
  const pipeline::BurstDecoder decoder = pipeline::BurstDecoder::make(rig, config).value();
  OrderCounts out;
  for (const std::uint64_t seed : seeds) {
    const ToothSteps steps = make_tooth_steps(scenes, seed);
    const auto scene = render(
        rig, [&steps](int u, int v) { return steps.depth_mm(u, v); }, steps.options(seed));
    out += score_orders(decoder.decode(scene.frames.view()), scene, steps.light, steps.near_jump);
  }
  return out;
}

/// Gum too narrow for the code lies beside a tooth one fringe higher.
TEST(ToothSteps, step_of_the_modulation_may_hide_a_jump) {
  const std::vector<std::uint64_t> seeds{70, 71, 72, 73, 74, 75, 76, 77, 78, 79, 80, 81};
  const auto wrong = [&](const pipeline::DecodeConfig& c) {
    return decode_teeth(cropped_rig(400, 300), c, seeds).wrong;
  };
  pipeline::DecodeConfig blind;  // the control: as unlikely a jump as anywhere else
  blind.order.shade_jump_cost = blind.order.unseen_jump_cost;
  EXPECT_LT(wrong({}), wrong(blind) * 19 / 20);
}

/// A strip of gum, narrow and long, is left beside a tooth one fringe higher.
TEST(ToothSteps, narrow_strips_of_gum_are_told_from_the_tooth_by_their_code_along_the_edge) {
  const auto largest = [&](const pipeline::DecodeConfig& c) {
    return decode_teeth(micro_rig(400, 300), c, {50412, 60005, 60313}).largest_wrong_px;
  };
  pipeline::DecodeConfig blind;  // the control: no strip is ever convincing
  blind.micro.refit.strip_evidence = std::numeric_limits<float>::infinity();
  EXPECT_GT(largest(blind), kLargeWrong_px);
  EXPECT_LE(largest({}), kLargeWrong_px);
}

/// The same, where the strip has so much more modulation than the tooth that it turns its block's gain.
TEST(ToothSteps, gain_that_no_blur_leaves_does_not_speak_for_an_order) {
  const auto largest = [&](const pipeline::DecodeConfig& c) {
    return decode_teeth(micro_rig(400, 300, kShippedRatio), c, {2526, 8839}).largest_wrong_px;
  };
  pipeline::DecodeConfig credulous;  // the control
  credulous.micro.refit.largest_gain = std::numeric_limits<float>::infinity();
  EXPECT_GT(largest(credulous), kLargeWrong_px);
  EXPECT_LE(largest({}), kLargeWrong_px);
}

}  // namespace
}  // namespace enamel::test
