// Flips are few, so that most of a row is passed over: which pixels are worked may not depend on where stretches begin.
#include "pipeline/decode/mode_t/flip_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

namespace enamel::pipeline {
namespace {

constexpr int kWidth = 131;

struct Row {
  PhaseMaps maps;
  Map<float> weight{kWidth, 1};
  std::vector<float> sigma_rad = std::vector<float>(kWidth), motion_rad = std::vector<float>(kWidth);

  explicit Row(unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<float> signal(-60, 60), share(0, 1), small(-0.05F, 0.05F);
    maps.resize(kWidth, 1);
    bool near = false;
    for (int u = 0; u < kWidth; ++u) {
      if (share(rng) < 0.08F) near = !near;
      const float c = signal(rng), s = signal(rng);
      maps.cosine_dn(u, 0) = c, maps.sine_dn(u, 0) = s, maps.code_dn(u, 0) = signal(rng);
      maps.modulation_dn(u, 0) = std::sqrt(c * c + s * s), maps.phase_rad(u, 0) = std::atan2(s, c);
      maps.mean_dn(u, 0) = 90, maps.sigma_rad(u, 0) = 0.02F;
      weight(u, 0) = (share(rng) < 0.5F ? -1.0F : 1.0F) * (near ? share(rng) : 1.0F);
      sigma_rad[static_cast<std::size_t>(u)] = 0.1F + 0.1F * share(rng);
      motion_rad[static_cast<std::size_t>(u)] = small(rng);
    }
  }
};

/// Each `step` pixels by themselves; 1: no stretch is passed over.
void rejoin(Row& row, int step) {
  const NoiseModel noise{.floor_dn2 = 1, .slope_dn = 0.02F, .black_dn = 8};
  for (int u = 0; u < kWidth; u += step) {
    const auto at = static_cast<std::size_t>(u);
    const FlipRow flips{row.sigma_rad.data() + at, row.motion_rad.data() + at, 1, 3};
    rejoin_flip_row(flips, noise, at, static_cast<std::size_t>(std::min(step, kWidth - u)), row.maps, row.weight);
  }
}

int differ(const Map<float>& a, const Map<float>& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], sizeof(float)) != 0 ? 1 : 0;
  return count;
}

TEST(FlipRows, a_row_at_once_is_the_same_as_its_pixels_one_by_one) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Row whole(seed), single(seed), untouched(seed);
    rejoin(whole, kWidth);
    rejoin(single, 1);
    EXPECT_EQ(differ(whole.maps.phase_rad, single.maps.phase_rad), 0);
    EXPECT_EQ(differ(whole.maps.sine_dn, single.maps.sine_dn), 0);
    EXPECT_EQ(differ(whole.maps.sigma_rad, single.maps.sigma_rad), 0);
    EXPECT_EQ(differ(whole.weight, single.weight), 0);
    // Negative control: there are pixels to be worked, and others.
    const int worked = differ(whole.maps.sigma_rad, untouched.maps.sigma_rad);
    EXPECT_GT(worked, 0);
    EXPECT_LT(worked, kWidth);
  }
}

}  // namespace
}  // namespace enamel::pipeline
