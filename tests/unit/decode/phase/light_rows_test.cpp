// Loops over rows against the sums that they stand for, pixel by pixel.
#include "pipeline/decode/phase/light_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace enamel::pipeline {
namespace {

constexpr std::size_t kWidth = 61;  ///< no multiple of what a register holds

struct Inputs {
  std::array<std::vector<float>, 9> rows;

  explicit Inputs(unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<float> light(2, 90), signal(-60, 60), weight(-0.3F, 1);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      rows[k].resize(kWidth);
      for (float& x : rows[k]) x = k == 0 ? light(rng) : k < 7 ? signal(rng) : std::max(weight(rng), 0.0F);
    }
  }
  [[nodiscard]] LightRow row() {
    auto& r = rows;
    return {r[0].data(), r[1].data(), r[2].data(), r[3].data(), r[4].data(),
            r[5].data(), r[6].data(), r[7].data(), r[8].data()};
  }
};

/// What the sums of the column B/A of fringes and its square have to be.
struct Said {
  double once = 0, twice = 0, count = 0;
};

Said said_of_fringe(const Inputs& in, std::size_t u) {
  const auto at = [&](std::size_t k) { return static_cast<double>(in.rows[k][u]); };
  if (!(at(7) > 0)) return {};
  const double b = std::hypot(at(1), at(2)), weight = at(7) * at(0) * at(0);
  return {weight * b / at(0), weight * b / at(0) * b / at(0), 1};
}

Said said_of_rest(const Inputs& in, std::size_t u) {
  const auto at = [&](std::size_t k) { return static_cast<double>(in.rows[k][u]); };
  if (!(at(8) > 0)) return {};
  return {at(8) * at(0) * at(3), at(8) * at(3) * at(3), 1};
}

struct Sums {
  std::vector<float> stretch = std::vector<float>(kLightColumns * kWidth, 0.0F);
  std::vector<float> sums = std::vector<float>((kLightCount + 1) * kWidth, 0.0F);

  [[nodiscard]] double at(std::size_t i, std::size_t j, std::size_t u) const {
    return static_cast<double>(sums[light_sum_of(i, j) * kWidth + u]);
  }
  [[nodiscard]] double count(std::size_t u) const { return static_cast<double>(sums[kLightCount * kWidth + u]); }
};

TEST(LightRows, sums_of_a_row_are_those_of_its_pixels_to_the_last_one) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Inputs in(seed);
    Sums fringe, rest;
    std::fill_n(fringe.stretch.begin() + kLevel * kWidth, kWidth, 1.0F);
    add_lamp_fringe_row(in.row(), LampLight::kAsSurface, kWidth, fringe.stretch.data(), fringe.sums.data());
    add_lamp_rest_row(in.row(), LampLight::kAsSurface, kWidth, rest.stretch.data(), rest.sums.data());
    for (std::size_t u = 0; u < kWidth; ++u) {
      const Said a = said_of_fringe(in, u), b = said_of_rest(in, u);
      EXPECT_NEAR(fringe.at(kLevel, kSaid, u), a.once, 1e-5 * a.once);
      EXPECT_NEAR(fringe.at(kSaid, kSaid, u), a.twice, 1e-5 * a.twice);
      EXPECT_EQ(fringe.count(u), a.count);
      EXPECT_NEAR(rest.at(kRest, kSaid, u), b.once, 1e-5 * std::abs(b.once));
      EXPECT_NEAR(rest.at(kSaid, kSaid, u), b.twice, 1e-5 * b.twice);
      EXPECT_EQ(rest.count(u), b.count);
    }
  }
}

// Negative control: the comparison above tells a pixel whose light is another one by a thousandth.
TEST(LightRows, a_pixel_of_another_light_is_told) {
  Inputs in(1), other(1);
  const auto asked = std::find_if(in.rows[7].begin(), in.rows[7].end(), [](float w) { return w > 0; });
  const auto u = static_cast<std::size_t>(asked - in.rows[7].begin());
  ASSERT_LT(u, kWidth);
  other.rows[0][u] *= 1.001F;
  Sums sums;
  add_lamp_fringe_row(other.row(), LampLight::kAsSurface, kWidth, sums.stretch.data(), sums.sums.data());
  const Said said = said_of_fringe(in, u);
  EXPECT_NEAR(sums.at(kSaid, kSaid, u), said.twice, 1e-5 * said.twice) << "B^2 knows no light";
  std::fill_n(sums.stretch.begin() + kLevel * kWidth, kWidth, 1.0F);
  std::fill(sums.sums.begin(), sums.sums.end(), 0.0F);
  add_lamp_fringe_row(other.row(), LampLight::kAsSurface, kWidth, sums.stretch.data(), sums.sums.data());
  EXPECT_GT(std::abs(sums.at(kLevel, kSaid, u) - said.once), 1e-4 * said.once);
}

}  // namespace
}  // namespace enamel::pipeline
