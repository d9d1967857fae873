// From the camera's memory into the form in which frames travel.
#include "firmware/acquire/frame_pixels.hpp"

#include <gmock/gmock.h>

#include <random>

#include "firmware/acquire/frame_digest.hpp"

namespace enamel::fw {
namespace {

constexpr int kWidth = 23, kHeight = 17;  // neither a multiple of four pixels
constexpr std::uint8_t kPadding = 0xEE;

std::vector<std::uint16_t> drawn_values(int bit_depth, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint16_t> values(static_cast<std::size_t>(kWidth) * kHeight);
  for (auto& v : values) v = static_cast<std::uint16_t>(random() % (1U << static_cast<unsigned>(bit_depth)));
  return values;
}

/// As MIPI CSI-2 says: P1[9:2] P2[9:2] P3[9:2] P4[9:2], then their low bits, P1's lowest.
void pack_ten(const std::uint16_t* row, std::uint8_t* out, std::size_t bytes) {
  std::fill(out, out + bytes, std::uint8_t{0});
  for (std::size_t x = 0; x < kWidth; ++x) {
    out[5 * (x / 4) + x % 4] = static_cast<std::uint8_t>(row[x] >> 2U);
    const std::size_t low = std::min(5 * (x / 4) + 4, bytes - 1);
    out[low] = static_cast<std::uint8_t>(out[low] | ((row[x] & 3U) << (2 * (x % 4))));
  }
}

CameraFrame frame_of(const std::vector<std::uint16_t>& values, PixelFormat format, std::size_t padding) {
  CameraFrame f;
  f.width = kWidth;
  f.height = kHeight;
  f.bit_depth = format == PixelFormat::kRaw8 ? 8 : 10;
  f.format = format;
  const std::size_t row = row_bytes(format, kWidth), stride = row + padding;
  std::vector<std::uint8_t> bytes(stride * kHeight, kPadding);
  for (std::size_t y = 0; y < kHeight; ++y) {
    const std::uint16_t* in = values.data() + y * kWidth;
    std::uint8_t* out = bytes.data() + y * stride;
    for (std::size_t x = 0; x < kWidth && format == PixelFormat::kRaw8; ++x) out[x] = static_cast<std::uint8_t>(in[x]);
    for (std::size_t x = 0; x < kWidth && format == PixelFormat::kRaw16; ++x) {
      out[2 * x] = static_cast<std::uint8_t>(in[x] & 0xFFU);
      out[2 * x + 1] = static_cast<std::uint8_t>(in[x] >> 8U);
    }
    if (format == PixelFormat::kRaw10Packed) pack_ten(in, out, row);
  }
  f.pixels = PixelLoan(std::move(bytes), stride);
  return f;
}

class FramePixels : public testing::TestWithParam<std::tuple<PixelFormat, std::size_t>> {
 protected:
  [[nodiscard]] static int depth() { return std::get<0>(GetParam()) == PixelFormat::kRaw8 ? 8 : 10; }
  [[nodiscard]] static CameraFrame frame(unsigned seed) {
    return frame_of(drawn_values(depth(), seed), std::get<0>(GetParam()), std::get<1>(GetParam()));
  }
};

TEST_P(FramePixels, travel_without_padding_and_unpacked) {
  AssembledBurst burst;
  for (unsigned k = 0; k < 4; ++k) burst.frames[k].frame = frame(k);
  const BurstPixels taken = take_pixels(burst);
  ASSERT_EQ(taken.bytes.size(), 4 * frame_bytes(kWidth, kHeight, depth()));
  const std::size_t bpp = bytes_per_pixel(depth()), count = static_cast<std::size_t>(kWidth) * kHeight;
  for (unsigned k = 0; k < 4; ++k) {
    const auto values = drawn_values(depth(), k);
    double sum = 0;
    std::uint64_t saturated = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = (k * count + i) * bpp;
      ASSERT_EQ(taken.bytes[at] + (bpp > 1 ? 256U * taken.bytes[at + 1] : 0U), values[i]) << k << " " << i;
      sum += values[i];
      saturated += values[i] == (1U << static_cast<unsigned>(depth())) - 1U ? 1U : 0U;
    }
    EXPECT_DOUBLE_EQ(taken.levels[k].mean_dn, sum / static_cast<double>(count));
    EXPECT_EQ(taken.levels[k].saturated, saturated);
    EXPECT_EQ(taken.levels[k].count, count);
  }
}

TEST_P(FramePixels, digest_sees_pixels_and_no_padding) {
  const FrameDigest one = digest(frame(1));
  const auto tight = frame_of(drawn_values(depth(), 1), std::get<0>(GetParam()), 0);
  EXPECT_EQ(one.hash, digest(tight).hash);
  EXPECT_DOUBLE_EQ(one.mean_dn, digest(tight).mean_dn);
  EXPECT_NE(one.hash, digest(frame(2)).hash);
}

TEST_P(FramePixels, memory_that_ends_early_is_no_frame) {
  CameraFrame f = frame(1);
  ASSERT_TRUE(is_whole(f));
  const auto all = f.pixels.bytes();
  const std::size_t padding = std::get<1>(GetParam());
  f.pixels = PixelLoan(std::vector<std::uint8_t>(all.begin(), all.end() - static_cast<std::ptrdiff_t>(padding + 1)),
                       row_bytes(f.format, kWidth) + padding);
  EXPECT_FALSE(is_whole(f));
  AssembledBurst burst;
  for (unsigned k = 0; k < 4; ++k) burst.frames[k].frame = frame(k);
  burst.frames[2].frame = f;
  EXPECT_TRUE(take_pixels(burst).bytes.empty());
}

INSTANTIATE_TEST_SUITE_P(Formats, FramePixels,
                         testing::Combine(testing::Values(PixelFormat::kRaw8, PixelFormat::kRaw16,
                                                          PixelFormat::kRaw10Packed),
                                          testing::Values(std::size_t{0}, std::size_t{9})));

TEST(FramePixels, go_back_to_their_lender_when_taken) {
  int returned = 0;
  const std::vector<std::uint8_t> memory(static_cast<std::size_t>(kWidth) * kHeight, 7);
  AssembledBurst burst;
  for (LitFrame& lit : burst.frames) {
    lit.frame = frame_of(drawn_values(8, 1), PixelFormat::kRaw8, 0);
    std::shared_ptr<const void> owner(nullptr, [&returned](const void*) { ++returned; });
    lit.frame.pixels = PixelLoan(memory, 0, std::move(owner));
  }
  const BurstPixels taken = take_pixels(burst);
  EXPECT_EQ(returned, 4);
  EXPECT_THAT(taken.bytes, testing::Each(testing::Eq(7)));
}

}  // namespace
}  // namespace enamel::fw
