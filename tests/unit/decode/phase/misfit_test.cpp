// Sigma that grows where the frames of a moving burst contradict each other by more than noise.
#include "pipeline/decode/phase/misfit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/moving_ball.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

using test::MovingBall;

constexpr int kWidth = 160, kHeight = 120;
constexpr float kSigma_rad = 0.01F;
/// Of four frames: their residual has variance 4 s^2, their phase s^2 / 2B^2.
constexpr float kShare = 8 * kSigma_rad * kSigma_rad;

/// Sigma after residuals of noise, times `times(u, v)`.
Map<float> widened(const std::function<float(int, int)>& times) {
  std::mt19937 random(7);
  std::normal_distribution<float> noise;
  Misfit misfit;
  misfit.start(kWidth, kHeight);
  std::vector<float> squares(kWidth), share(kWidth, kShare);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) squares[static_cast<std::size_t>(u)] = std::pow(times(u, v) * noise(random), 2.0F);
    misfit.take_row(v, {squares.data(), share.data()});
  }
  Map<float> sigma(kWidth, kHeight, kSigma_rad);
  misfit.add_to(sigma, kPhaseOfClosure);
  return sigma;
}

double mean_of(const Map<float>& sigma, int from_u, int to_u, int from_v, int to_v) {
  double sum = 0;
  for (int v = from_v; v < to_v; ++v) {
    for (int u = from_u; u < to_u; ++u) sum += static_cast<double>(sigma(u, v));
  }
  return sum / ((to_u - from_u) * (to_v - from_v));
}

TEST(Misfit, noise_alone_adds_next_to_nothing) {
  const auto sigma = widened([](int, int) { return 1.0F; });
  EXPECT_LT(mean_of(sigma, 0, kWidth, 0, kHeight), 1.02 * static_cast<double>(kSigma_rad));
  for (const float s : sigma.pixels()) EXPECT_GE(s, kSigma_rad);
}

TEST(Misfit, what_exceeds_noise_goes_into_sigma_where_it_is_seen) {
  constexpr int kFrom = 48, kTo = 96, kReach_px = 12;
  constexpr double kTimes = 4;
  const auto sigma = widened(
      [](int u, int v) { return u >= kFrom && u < kTo && v >= kFrom && v < kTo ? static_cast<float>(kTimes) : 1.0F; });
  const double s = static_cast<double>(kSigma_rad), c = static_cast<double>(kPhaseOfClosure);
  const double expected = std::sqrt(s * s + c * c * static_cast<double>(kShare) * (kTimes * kTimes - 1));
  EXPECT_NEAR(mean_of(sigma, kFrom + kReach_px, kTo - kReach_px, kFrom + kReach_px, kTo - kReach_px), expected,
              0.06 * expected);
  EXPECT_LT(mean_of(sigma, 0, kFrom - kReach_px, 0, kHeight), 1.02 * s) << "negative control: beside the patch";
  EXPECT_LT(mean_of(sigma, kTo + kReach_px, kWidth, 0, kHeight), 1.02 * s);
}

TEST(Misfit, pixels_without_a_residual_and_those_at_an_edge_say_nothing) {
  constexpr float kEdge = 1e6F;  // times noise
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  const auto sigma = widened([&](int u, int v) { return u % 3 == 1 ? kEdge : v % 5 == 2 ? unknown : 1.0F; });
  EXPECT_LT(mean_of(sigma, 0, kWidth, 0, kHeight), 1.03 * static_cast<double>(kSigma_rad));
}

TEST(Misfit, one_pixel_and_odd_sizes_are_widened_too) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {9, 1}, {17, 3}}) {
    Misfit misfit;
    misfit.start(width, height);
    const std::vector<float> squares(static_cast<std::size_t>(width), 25), share(squares.size(), kShare);
    for (int v = 0; v < height; ++v) misfit.take_row(v, {squares.data(), share.data()});
    Map<float> sigma(width, height, kSigma_rad);
    misfit.add_to(sigma, kPhaseOfClosure);
    for (const float s : sigma.pixels())
      EXPECT_TRUE(s > 2 * kSigma_rad && s < 10 * kSigma_rad) << width << 'x' << height;
  }
}

class MisfitOf : public test::BothModes {};

INSTANTIATE_TEST_SUITE_P(Modes, MisfitOf, testing::Bool(), [](const auto& mode) { return mode.param ? "M" : "T"; });

/// The ball as it moves, and at rest.
std::pair<DecodedBurst, DecodedBurst> decode_both(const MovingBall& ball) {
  const auto decoder = BurstDecoder::make(ball.rig, {}).value();
  return {decoder.decode(ball.render(true).view()), decoder.decode(ball.at_rest().render(true).view())};
}

/// Share of the decoded pixels that are off by more than four of the sigmas given.
double beyond_four_sigmas(const MovingBall& ball, const DecodedBurst& burst, const Map<float>& sigma_mm) {
  double count = 0, beyond = 0;
  for (int v = 0; v < burst.patch.depth_mm.height(); ++v) {
    for (int u = 0; u < burst.patch.depth_mm.width(); ++u) {
      const float z = burst.patch.depth_mm(u, v), sigma = sigma_mm(u, v);
      if (!(std::isfinite(z) && sigma > 0)) continue;
      count += 1;
      beyond += std::abs(static_cast<double>(z) - ball.depth(u, v, 0)) > 4 * static_cast<double>(sigma) ? 1 : 0;
    }
  }
  EXPECT_GT(count, 10000);
  return beyond / count;
}

/// Fissures as narrow as those of a molar pass by at two pixels a frame: their light changes within fewer pixels than
/// the motion is known at.
TEST_P(MisfitOf, passing_fissures_do_not_exceed_their_sigma) {
  MovingBall ball{rig(), {0.060, 0.010, 0.01}, Eigen::Vector3d::Zero()};
  ball.fissure = 0.5;
  const auto [moved, at_rest] = decode_both(ball);
  ASSERT_TRUE(moved.accepted() && moved.diagnostics.rigid.moved);
  const double own = beyond_four_sigmas(ball, moved, moved.patch.sigma_mm),
               of_noise = beyond_four_sigmas(ball, moved, at_rest.patch.sigma_mm);
  EXPECT_LT(own, 0.3 * of_noise) << "negative control: sigmas of noise alone";
}

/// Light that changes no faster than the motion is known at is undone, not doubted.
TEST_P(MisfitOf, passing_texture_keeps_the_sigma_it_has_at_rest) {
  const MovingBall ball{rig(), {0.030, 0.005, 0.01}, Eigen::Vector3d::Zero()};
  const auto [moved, at_rest] = decode_both(ball);
  double ratio = 0, count = 0;
  for (int v = 120; v < 240; ++v) {
    for (int u = 160; u < 320; ++u) {
      const float a = moved.patch.sigma_mm(u, v), b = at_rest.patch.sigma_mm(u, v);
      if (a > 0 && b > 0) ratio += static_cast<double>(a / b), count += 1;
    }
  }
  ASSERT_GT(count, 10000);
  EXPECT_LT(ratio / count, 1.05);
}

}  // namespace
}  // namespace enamel::pipeline
