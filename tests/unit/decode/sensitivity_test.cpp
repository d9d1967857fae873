// Chosen numbers are no laws: what is found hardly depends on them within 30 %, and does beyond.
#include "tests/unit/decode/sensitivity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/support/order_score.hpp"
#include "tests/support/tooth_steps.hpp"
#include "tests/unit/decode/moving_ball.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {
namespace {

constexpr int kWidth = 400, kHeight = 300;

calib::Rig rig_of(bool micro) {
  return micro ? micro_rig(kWidth, kHeight, kShippedRatio) : cropped_rig(kWidth, kHeight);
}

/// How a row of teeth goes by.
struct Going {
  int shift_px = 0;       ///< a frame interval
  double brightness = 1;  ///< above 1.3 crests of the fringes saturate
};

/// Rows of teeth as one burst sees them.
struct TeethBurst {
  ToothSteps steps;
  SyntheticBurst truth;
  FrameSet frames;
};

/// shift_px: even, for frames lie at half intervals; with it teeth come nearer by 0.02 mm each.
TeethBurst render_teeth(const calib::Rig& rig, std::uint64_t seed, const Going& going) {
  const int shift_px = going.shift_px;
  TeethBurst out{make_tooth_steps(cropped_rig(kWidth, kHeight), seed), {}, {}};
  const auto at = [&](double tau) {
    const int by = static_cast<int>(std::lround(tau * shift_px));
    const double nearer_mm = shift_px != 0 ? 0.02 * tau : 0;
    const auto column = [by](int u) { return std::clamp(u - by, 0, kWidth - 1); };
    SceneOptions o = out.steps.options(seed + static_cast<std::uint64_t>(std::lround(10 * (tau + 2))));
    o.light = [&](int u, int v) { return going.brightness * out.steps.light(column(u), v); };
    o.contrast = [&](int u, int v) { return out.steps.contrast(column(u), v); };
    return render(
        rig, [&](int u, int v) { return out.steps.depth_mm(column(u), v) - nearer_mm; }, o);
  };
  out.truth = at(0);
  out.frames = shift_px != 0 ? frames_in_motion(at) : out.truth.frames;
  return out;
}

/// placed: of the lit pixels; error: rms, um.
Judge teeth(bool micro, Going going = {}) {
  const calib::Rig rig = rig_of(micro);
  std::vector<TeethBurst> bursts;
  for (const std::uint64_t seed : {3U, 11U, 27U, 42U, 58U, 76U}) bursts.push_back(render_teeth(rig, seed, going));
  return [rig, bursts = std::move(bursts)](const DecodeConfig& config) {
    const auto decoder = pipeline::BurstDecoder::make(rig, config).value();
    std::vector<Figures> out;
    for (const TeethBurst& b : bursts) {
      const OrderCounts n = score_orders(decoder.decode(b.frames.view()), b.truth, b.steps.light, b.steps.near_jump);
      out.push_back({100 * static_cast<double>(n.accepted) / static_cast<double>(n.lit), n.wrong_pct(), n.rms_um()});
    }
    return out;
  };
}

/// Textured balls that move; error: of the middle pixel, um, as a standard deviation.
Judge balls(bool micro) {
  const calib::Rig rig = rig_of(micro);
  std::vector<std::pair<MovingBall, FrameSet>> bursts;
  for (const double way : {-1.0, -0.6, 0.6, 1.0}) {
    MovingBall ball{rig, {0.030 * way, -0.015, 0.024 * way}, {0.0006, -0.0004 * way, 0.0010}};
    ball.radius_mm = 8;
    bursts.emplace_back(ball, ball.render(true));
  }
  return [rig, bursts = std::move(bursts)](const DecodeConfig& config) {
    const auto decoder = pipeline::BurstDecoder::make(rig, config).value();
    std::vector<Figures> out;
    for (const auto& [ball, frames] : bursts) {
      const auto burst = decoder.decode(frames.view());
      const auto placed = static_cast<double>(burst.patch.valid_px) / static_cast<double>(burst.reject.size());
      out.push_back(burst.accepted() ? Figures{100 * placed, 0, ball.sigma_um(burst)} : Figures{});
    }
    return out;
  };
}

class SensitivityOf : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Modes, SensitivityOf, testing::Bool(),
                         [](const auto& mode) { return mode.param ? "M" : "T"; });

std::string in_mode(const std::string& group) { return group + (SensitivityOf::GetParam() ? " M" : " T"); }

TEST_P(SensitivityOf, phase_masks_what_it_is_told_to) {
  expect_no_laws(in_mode("phase"), teeth(GetParam(), {0, 1.4}),
                 {rest_times(ENAMEL_MEMBER(phase.saturation)), times(ENAMEL_MEMBER(phase.max_sigma_rad))},
                 {{times(ENAMEL_MEMBER(phase.max_sigma_rad)), 0.1}, {times(ENAMEL_MEMBER(phase.saturation)), 0.3}});
}

TEST_P(SensitivityOf, unwrap_needs_no_exact_odds) {
  expect_no_laws(in_mode("unwrap"), teeth(GetParam()),
                 {tangent_times(ENAMEL_MEMBER(links.max_slope_deg)), times(ENAMEL_MEMBER(links.max_deviation_rad)),
                  times(ENAMEL_MEMBER(order.outlier_cost)), times(ENAMEL_MEMBER(order.unseen_jump_cost)),
                  times(ENAMEL_MEMBER(order.kink_jump_cost)), times(ENAMEL_MEMBER(order.shade_jump_cost)),
                  times(ENAMEL_MEMBER(order.fold_cost)), times(ENAMEL_MEMBER(order.missed_contact_cost)),
                  times(ENAMEL_MEMBER(order.lit_twice_cost)), times(ENAMEL_MEMBER(order.least_claim)),
                  times(ENAMEL_MEMBER(order.decided_margin)), times(ENAMEL_MEMBER(order.beyond_range_cost)),
                  rest_times(ENAMEL_MEMBER(order.row_memory)), times(ENAMEL_MEMBER(order.inherit_cost)),
                  times(ENAMEL_MEMBER(order.min_region_px))},
                 {{times(ENAMEL_MEMBER(order.decided_margin)), 10}, {times(ENAMEL_MEMBER(order.unseen_jump_cost)), 0}});
}

TEST_P(SensitivityOf, motion_is_found_under_any_like_priors) {
  expect_no_laws(in_mode("motion"), balls(GetParam()),
                 {times(ENAMEL_MEMBER(rigid.max_residual)), times(ENAMEL_MEMBER(rigid.shared_prior)),
                  times(ENAMEL_MEMBER(rigid.min_pixels)), times(ENAMEL_MEMBER(rigid.passes)),
                  times(ENAMEL_MEMBER(rigid.negligible_rad))},
                 {{times(ENAMEL_MEMBER(rigid.passes)), 0}, {times(ENAMEL_MEMBER(rigid.negligible_rad)), 1000}});
}

TEST(Sensitivity, mode_t_on_teeth_that_pass) {
  expect_no_laws(
      "mode_t", teeth(false, {2, 1}),
      {times(ENAMEL_MEMBER(four_step.polarity.flip_full_rad)), times(ENAMEL_MEMBER(four_step.closure.block_px)),
       times(ENAMEL_MEMBER(four_step.closure.max_residual)), times(ENAMEL_MEMBER(four_step.closure.motion_prior_rad)),
       times(ENAMEL_MEMBER(four_step.closure.harmonic_prior)), times(ENAMEL_MEMBER(four_step.flips.block_px)),
       times(ENAMEL_MEMBER(four_step.flips.drop_sigmas)), times(ENAMEL_MEMBER(four_step.flips.full_sigmas)),
       times(ENAMEL_MEMBER(four_step.flips.least_sigma_rad)), times(ENAMEL_MEMBER(four_step.flips.prior_pixels)),
       times(ENAMEL_MEMBER(four_step.torn.sigmas)), times(ENAMEL_MEMBER(four_step.torn.most_turn_rad)),
       times(ENAMEL_MEMBER(four_step.torn.same_light))},
      {{times(ENAMEL_MEMBER(four_step.torn.sigmas)), 0}});
}

TEST(Sensitivity, mode_m_on_teeth_that_pass) {
  expect_no_laws(
      "mode_m", teeth(true, {2, 1}),
      {times(ENAMEL_MEMBER(micro.refit.block_px)), times(ENAMEL_MEMBER(micro.refit.passes)),
       times(ENAMEL_MEMBER(micro.refit.max_residual)), times(ENAMEL_MEMBER(micro.refit.motion_prior_rad)),
       times(ENAMEL_MEMBER(micro.refit.gain_prior)), times(ENAMEL_MEMBER(micro.refit.largest_motion_rad)),
       times(ENAMEL_MEMBER(micro.refit.torn_sigmas)), times(ENAMEL_MEMBER(micro.refit.largest_gain)),
       times(ENAMEL_MEMBER(micro.motion.harmless_motion_rad)), rest_times(ENAMEL_MEMBER(micro.motion.clear_agreement))},
      {{times(ENAMEL_MEMBER(micro.refit.torn_sigmas)), 0.1}, {times(ENAMEL_MEMBER(micro.refit.max_residual)), 0}});
}

}  // namespace
}  // namespace enamel::test
