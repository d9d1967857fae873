// Sine and cosine of the four frames' phases about mid-burst, composed from two angles, against the library's.
#include "pipeline/decode/phase/frame_turns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace enamel::pipeline {
namespace {

constexpr double kBound = 1e-6;

double worst_of(const Turns& turns, double rate, double rate_change) {
  double worst = 0, t = -1.5;
  for (const Turn& found : {turns.a0, turns.a1, turns.a2, turns.a3}) {
    const double angle = t * rate + t * t * rate_change / 2;
    worst = std::max({worst, std::abs(static_cast<double>(found.cos) - std::cos(angle)),
                      std::abs(static_cast<double>(found.sin) - std::sin(angle))});
    t += 1;
  }
  return worst;
}

/// Over rates up to most_rate and changes up to most_change of either sign.
double worst_error(double most_rate, double most_change) {
  constexpr int kSteps = 200;
  double worst = 0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (int j = -kSteps; j <= kSteps; ++j) {
      const auto rate = static_cast<float>(most_rate * i / kSteps),
                 change = static_cast<float>(most_change * j / kSteps);
      worst = std::max(worst, worst_of(turns_of<false>({rate, change, 0, 0}), static_cast<double>(rate),
                                       static_cast<double>(change)));
    }
  }
  return worst;
}

TEST(FrameTurns, are_true_to_a_millionth_for_motion_that_can_be_measured) {
  EXPECT_LT(worst_error(1, 0.3), kBound);
  EXPECT_GT(worst_error(1, 3), 100 * kBound) << "negative control: beyond the range";
}

TEST(FrameTurns, of_steady_motion_are_those_of_a_change_of_zero) {
  for (const float rate : {-1.0F, -0.2F, 0.0F, 0.003F, 0.7F}) {
    EXPECT_LT(worst_of(turns_of<true>({rate, 0, 0, 0}), static_cast<double>(rate), 0), kBound) << rate;
    EXPECT_GT(worst_of(turns_of<true>({rate, 0, 0, 0}), static_cast<double>(rate), 0.01), 100 * kBound)
        << "negative control: a change that is left out, " << rate;
  }
}

}  // namespace
}  // namespace enamel::pipeline
