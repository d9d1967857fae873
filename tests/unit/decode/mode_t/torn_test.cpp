// Pixels that an edge passed by during a burst of mode T: left out, or solved from the three frames that saw one
// surface.
#include "pipeline/decode/mode_t/torn.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr FourStepPixel kPixel{90, 31, -44};
constexpr PixelChange kChange{0.17F, -0.04F, 0, 0};

/// Frames of kPixel at their own times, b = +1.
Frames frames_of(const PixelChange& change) {
  const auto [mean, cosine, sine] = kPixel;
  Frames out{};
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double turned = static_cast<double>(change.turned(static_cast<float>(k) - 1.5F));
    const double phase = turned + static_cast<double>(k) * std::numbers::pi / 2;
    out[k] = static_cast<float>(static_cast<double>(mean) + static_cast<double>(cosine) * std::cos(phase) -
                                static_cast<double>(sine) * std::sin(phase));
  }
  return out;
}

void expect_pixel(const FourStepPixel& found) {
  EXPECT_NEAR(found.mean, kPixel.mean, 1e-3);
  EXPECT_NEAR(found.cosine, kPixel.cosine, 1e-3);
  EXPECT_NEAR(found.sine, kPixel.sine, 1e-3);
}

TEST(ThreeFrames, any_three_at_their_own_times_give_the_pixel_at_mid_burst) {
  for (std::size_t missing = 0; missing < 4; ++missing) {
    Frames frames = frames_of(kChange);
    frames[missing] = 5;
    expect_pixel(solve_without(missing, frames, kChange, 0));
    const FourStepPixel still = solve_without(missing, frames);
    EXPECT_GT(std::hypot(still.cosine - kPixel.cosine, still.sine - kPixel.sine), 3)
        << "negative control: as if nothing had moved, without frame " << missing;
  }
}

TEST(ThreeFrames, at_rest_both_ways_agree_and_rows_solve_alike) {
  const Frames still = frames_of({0, 0, 0, 0}), moved = frames_of(kChange);
  for (std::size_t missing = 0; missing < 4; ++missing) expect_pixel(solve_without(missing, still));
  expect_pixel(solve_first_three({moved[0], moved[1], moved[2], 5}, turns_of<false>(kChange)));
}

/// A plate before a plane, both coming nearer while the plate's right edge passes at `edge_px` a frame interval.
struct PassingPlate {
  static constexpr int kWidth = 480, kHeight = 96, kEdge = 250, kReach_px = 8;
  static constexpr double kAxial_mm = 0.03;
  double edge_px, behind_mm;
  calib::Rig rig = test::cropped_rig(kWidth, kHeight);

  /// tau: frame intervals after mid-burst.
  [[nodiscard]] double depth(int u, double tau) const {
    return 46.5 + (u < kEdge + edge_px * tau ? 0 : behind_mm) + kAxial_mm * tau;
  }
  [[nodiscard]] test::FrameSet render() const {
    test::SceneOptions o;
    o.noise = true;
    return test::frames_in_motion([&](double tau) {
      return test::render(
          rig, [&](int u, int) { return depth(u, tau); }, o);
    });
  }
};

/// Of the pixels beside the edges of several such plates.
struct Count {
  std::size_t decoded = 0, wrong = 0;  ///< wrong: another surface than at mid-burst
};

Count beside_edges(const TornConfig& torn, float max_sigma_rad = PhaseConfig{}.max_sigma_rad) {
  DecodeConfig config;
  config.four_step.torn = torn;
  config.phase.max_sigma_rad = max_sigma_rad;
  Count out;
  for (const double behind_mm : {2.3, 3.0}) {
    for (const double edge_px : {2.0, -2.0, 1.3, -1.3}) {
      const PassingPlate plate{edge_px, behind_mm};
      const DecodedBurst burst = BurstDecoder::make(plate.rig, config).value().decode(plate.render().view());
      EXPECT_TRUE(burst.accepted() && burst.diagnostics.rigid.moved);
      for (int v = 0; v < PassingPlate::kHeight; ++v) {
        for (int u = PassingPlate::kEdge - PassingPlate::kReach_px; u < PassingPlate::kEdge + PassingPlate::kReach_px;
             ++u) {
          const auto z = static_cast<double>(burst.patch.depth_mm(u, v));
          if (!std::isfinite(z)) continue;
          ++out.decoded;
          out.wrong += std::abs(z - plate.depth(u, 0)) > 0.2 ? 1U : 0U;
        }
      }
    }
  }
  return out;
}

TornConfig trusting() {
  TornConfig config;
  config.sigmas = 1e6F, config.reach_px = 0;
  return config;
}

TornConfig rejecting() {
  TornConfig config;
  config.reach_px = 0;
  return config;
}

TEST(PassedEdge, pixels_that_saw_two_surfaces_are_not_believed) {
  const Count trusted = beside_edges(trusting()), rejected = beside_edges(rejecting());
  EXPECT_GT(trusted.wrong, 300U) << "negative control: residuals that nobody asked";
  EXPECT_LT(10 * rejected.wrong, trusted.wrong);
}

TEST(PassedEdge, pixels_are_given_back_where_three_frames_saw_one_surface) {
  const Count without = beside_edges(rejecting());
  const auto wrong_of_given_back = [&](const Count& with) {
    EXPECT_GT(with.decoded, without.decoded + 500);
    return static_cast<double>(with.wrong - without.wrong) / static_cast<double>(with.decoded - without.decoded);
  };
  TornConfig careless;
  careless.continues_sigmas = 100, careless.same_light = 1, careless.most_turn_rad = 3;
  // Where two frames saw the one surface and two the other, a third frame may look like both.
  const double wrong = wrong_of_given_back(beside_edges({})), guessed = wrong_of_given_back(beside_edges(careless));
  EXPECT_LT(wrong, 0.15);
  EXPECT_GT(guessed, 2 * wrong) << "negative control: ways that need not continue anything";
}

TEST(PassedEdge, nothing_is_given_back_that_the_gate_of_noise_would_reject) {
  const float below_mixed = 0.9F * TornConfig{}.mixed_rad;
  EXPECT_EQ(beside_edges({}, below_mixed).decoded, beside_edges(rejecting(), below_mixed).decoded);
}

/// Given back, a pixel says how far it may be off; away from the edge nothing changes.
TEST(PassedEdge, sigma_holds_for_what_is_given_back) {
  const PassingPlate plate{2.0, 2.3};
  const auto decode = [&](const TornConfig& torn) {
    DecodeConfig config;
    config.four_step.torn = torn;
    return BurstDecoder::make(plate.rig, config).value().decode(plate.render().view());
  };
  const DecodedBurst without = decode(rejecting()), with = decode({});
  double regained = 0, beyond = 0;
  for (int v = 0; v < PassingPlate::kHeight; ++v) {
    for (int u = 0; u < PassingPlate::kWidth; ++u) {
      const float z = with.patch.depth_mm(u, v), before = without.patch.depth_mm(u, v);
      const float sigma = with.patch.sigma_mm(u, v);
      if (std::abs(u - PassingPlate::kEdge) > 3 * PassingPlate::kReach_px) {
        EXPECT_EQ(with.reject(u, v), without.reject(u, v)) << u << ' ' << v;
      }
      if (!std::isfinite(z) || std::isfinite(before)) continue;
      regained += 1;
      beyond += std::abs(static_cast<double>(z) - plate.depth(u, 0)) > 3 * static_cast<double>(sigma) ? 1 : 0;
      EXPECT_EQ(with.reject(u, v), PixelReject::kNone);
    }
  }
  ASSERT_GT(regained, 50);
  EXPECT_LT(beyond, 0.2 * regained);
}

}  // namespace
}  // namespace enamel::pipeline
