#include "pipeline/decode/phase/block_fit.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace enamel::pipeline {
namespace {

/// One unknown's column is cos, the other's sin of an angle; `seen` turns of it are in the block.
using Fit = BlockFit<2>;
constexpr Fit::Spread kFree = {1, 1};
constexpr double kSigma = 0.1;
constexpr int kPixels = 2000;

Fit fit(double seen_turns, const std::function<double(double)>& residual) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, kSigma);
  std::array<double, Fit::kSums> sums{};
  const auto add = [&](std::size_t k, double x) { sums[k] += x / (kSigma * kSigma); };
  for (int i = 0; i < kPixels; ++i) {
    const double angle = 2 * std::numbers::pi * seen_turns * i / kPixels;
    const double c = std::cos(angle), s = std::sin(angle), r = residual(angle) + noise(random);
    add(0, c * c), add(1, c * s), add(2, c * r), add(3, s * s), add(4, s * r), add(5, r * r);
    sums[6] += 1;
  }
  return Fit(sums.data());
}

TEST(BlockFit, finds_unknowns_within_the_sigma_that_it_tells) {
  const auto known = fit(1, [](double a) { return 0.3 * std::cos(a) - 0.2 * std::sin(a); }).solve(kFree);
  EXPECT_NEAR(known.sigma(0), kSigma * std::sqrt(2.0 / kPixels), 1e-4);
  EXPECT_NEAR(known.x[0], 0.3, 4 * known.sigma(0));
  EXPECT_NEAR(known.x[1], -0.2, 4 * known.sigma(1));
}

TEST(BlockFit, says_that_a_small_part_of_a_turn_tells_the_unknowns_apart_badly) {
  EXPECT_GT(fit(0.05, [](double) { return 0; }).solve(kFree).sigma(1),
            5 * fit(1, [](double) { return 0; }).solve(kFree).sigma(1));
}

TEST(BlockFit, tells_what_the_first_unknown_explains_from_what_nothing_does) {
  const auto first = fit(1, [](double a) { return 0.1 * std::cos(a); }).told_by_first<1>(kFree);
  const auto other = fit(1, [](double a) { return 0.1 * std::sin(a); }).told_by_first<1>(kFree);
  const auto neither = fit(1, [](double a) { return 0.1 * std::cos(2 * a); }).told_by_first<1>(kFree);
  const double chi_squared = kPixels / 2.0;  // of 0.1 cos over kSigma
  constexpr double kByChance = 300;          // five sigmas of chi squared, 5 sqrt(2 n)
  EXPECT_NEAR(first.first, chi_squared, kByChance);
  EXPECT_NEAR(first.left, 0, kByChance);
  EXPECT_NEAR(other.first, 0, 10);
  EXPECT_NEAR(other.left, 0, kByChance);
  EXPECT_NEAR(neither.first, 0, 10);
  EXPECT_NEAR(neither.left, chi_squared, kByChance);
}

}  // namespace
}  // namespace enamel::pipeline
