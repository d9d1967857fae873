#include "protocol/types/burst.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/protocol/random_messages.hpp"

namespace enamel::proto {
namespace {

TEST(Burst, a_whole_one_is_consistent) {
  EXPECT_TRUE(is_consistent(test::camera_burst(3, 16, 12)));
  EXPECT_TRUE(is_consistent(test::camera_burst(3, 16, 12, 12)));
  EXPECT_FALSE(is_consistent(Burst{}));
}

TEST(Burst, every_damage_is_found) {
  const std::vector<std::pair<const char*, std::function<void(Burst&)>>> damages{
      {"pixel", [](Burst& b) { b.payload[5] ^= 1U; }},
      {"crc", [](Burst& b) { b.payload_crc32 ^= 1U; }},
      {"short payload", [](Burst& b) { b.payload.pop_back(); }},
      {"no payload", [](Burst& b) { b.payload.clear(); }},
      {"width", [](Burst& b) { b.width = 17; }},
      {"zero height", [](Burst& b) { b.height = 0; }},
      {"codec", [](Burst& b) { b.codec = Codec::kJpegLs; }},
      {"depth", [](Burst& b) { b.bit_depth = 10; }},
      {"depth 17", [](Burst& b) { b.codec = Codec::kRaw16, b.bit_depth = 17; }},
      {"frames", [](Burst& b) { b.frames = 3; }},
      {"metas", [](Burst& b) { b.meta.pop_back(); }},
      {"offset", [](Burst& b) { b.meta[2].offset += 1; }},
      {"length", [](Burst& b) { b.meta[1].length -= 1; }},
      {"order of frames", [](Burst& b) { std::swap(b.meta[1].t_strobe_ns, b.meta[2].t_strobe_ns); }},
      {"absurd time", [](Burst& b) { b.meta[3].t_strobe_ns = ~std::uint64_t{0}; }},
  };
  for (const auto& [name, damage] : damages) {
    Burst b = test::camera_burst(3, 16, 12);
    damage(b);
    EXPECT_FALSE(is_consistent(b)) << name;
  }
}

TEST(Burst, mid_is_between_first_start_and_last_end) {
  Burst b = test::camera_burst(0, 4, 4);
  for (std::size_t k = 0; k < 4; ++k) b.meta[k].t_strobe_ns = 1000 + 100 * k;
  b.meta[3].exposure_us = 3;
  EXPECT_EQ(to_ns(mid_burst(b)), (1000 + 1300 + 3000) / 2);
}

TEST(Burst, period_and_spread_of_the_light) {
  Burst b = test::camera_burst(0, 4, 4);
  for (std::size_t k = 0; k < 4; ++k) {
    b.meta[k].t_strobe_ns = 1'000'000 + 4'000'000 * k;
    b.meta[k].exposure_us = 2000;
  }
  EXPECT_NEAR(frame_period_s(b), 4e-3, 1e-15);
  // Exposures centred 6, 2, 2, 6 ms from the middle, each 2 ms long.
  EXPECT_NEAR(exposure_spread_s2(b), (36 + 4) / 2 * 1e-6 + 4e-6 / 12, 1e-12);
  b.meta.pop_back();
  EXPECT_EQ(frame_period_s(b), 0);
  EXPECT_EQ(exposure_spread_s2(b), 0);
}

TEST(Burst, frames_lie_behind_one_another) {
  const Burst b = test::camera_burst(0, 4, 3);
  for (int k = 0; k < 4; ++k) {
    ASSERT_EQ(frame_bytes(b, k).size(), 12U);
    EXPECT_EQ(frame_bytes(b, k).data(), b.payload.data() + 12 * k);
  }
  EXPECT_TRUE(frame_bytes(b, 4).empty());
}

}  // namespace
}  // namespace enamel::proto
