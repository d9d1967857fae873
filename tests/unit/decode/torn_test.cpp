// Pixels that an edge passed by during a burst of mode T: left out, or solved from the three frames that saw one
// surface.
#include "pipeline/algo/phase/torn.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "pipeline/algo/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::algo {
namespace {

constexpr FourStepPixel kPixel{90, 31, -44};
constexpr PixelChange kChange{0.17F, -0.04F, 0, 0};

/// Frames of kPixel at their own times, b = +1.
FourFrames frames_of(const PixelChange& change) {
  const auto turned = [&](double t) { return static_cast<double>(change.turned(static_cast<float>(t))); };
  const double a = static_cast<double>(kPixel.mean), c = static_cast<double>(kPixel.cosine),
               s = static_cast<double>(kPixel.sine);
  const auto cosine = [&](double t) { return std::cos(turned(t)); };
  const auto sine = [&](double t) { return std::sin(turned(t)); };
  return {static_cast<float>(a + c * cosine(-1.5) - s * sine(-1.5)),
          static_cast<float>(a - s * cosine(-0.5) - c * sine(-0.5)),
          static_cast<float>(a - c * cosine(0.5) + s * sine(0.5)),
          static_cast<float>(a + s * cosine(1.5) + c * sine(1.5))};
}

void expect_pixel(const FourStepPixel& found) {
  EXPECT_NEAR(found.mean, kPixel.mean, 1e-3);
  EXPECT_NEAR(found.cosine, kPixel.cosine, 1e-3);
  EXPECT_NEAR(found.sine, kPixel.sine, 1e-3);
}

TEST(FrameSolve, three_frames_at_their_own_times_give_the_pixel_at_mid_burst) {
  const FourFrames frames = frames_of(kChange);
  const Turns turns = turns_of<false>(kChange);
  expect_pixel(solve_first_three(frames, turns));
  expect_pixel(solve_last_three(frames, turns));
  const FourStepPixel without = solve_last_three(frames, turns_of<false>({0, 0, 0, 0}));
  EXPECT_GT(std::abs(without.cosine - kPixel.cosine), 3) << "negative control: as if nothing had moved";
}

TEST(FrameSolve, each_three_do_without_the_fourth) {
  FourFrames frames = frames_of(kChange);
  const Turns turns = turns_of<false>(kChange);
  frames.x3 = 5;
  expect_pixel(solve_first_three(frames, turns));
  frames = frames_of(kChange);
  frames.x0 = 5;
  expect_pixel(solve_last_three(frames, turns));
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
  [[nodiscard]] test::SyntheticBurst render() const {
    test::SyntheticBurst out;
    for (std::size_t k = 0; k < 4; ++k) {
      const double tau = static_cast<double>(k) - 1.5;
      test::SceneOptions o;
      o.noise = true;
      auto at = test::render(
          rig, [&](int u, int) { return depth(u, tau); }, o);
      if (k == 0) out = at;
      out.frames.frames[k] = at.frames.frames[k];
    }
    return out;
  }
};

/// Of the pixels beside the edges of several such plates.
struct Count {
  std::size_t decoded = 0, wrong = 0;  ///< wrong: another surface than at mid-burst
};

Count beside_edges(const TornConfig& torn) {
  DecodeConfig config;
  config.torn = torn;
  Count out;
  for (const double behind_mm : {2.3, 3.0}) {
    for (const double edge_px : {2.0, -2.0, 1.3, -1.3}) {
      const PassingPlate plate{edge_px, behind_mm};
      const DecodedBurst burst = BurstDecoder::make(plate.rig, config).value().decode(plate.render().frames.view());
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

/// Given back, a pixel says how far it may be off; away from the edge nothing changes.
TEST(PassedEdge, sigma_holds_for_what_is_given_back) {
  const PassingPlate plate{2.0, 2.3};
  const auto decode = [&](const TornConfig& torn) {
    DecodeConfig config;
    config.torn = torn;
    return BurstDecoder::make(plate.rig, config).value().decode(plate.render().frames.view());
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
}  // namespace enamel::algo
