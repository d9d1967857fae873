// Loops that ask but some pixels of a row against those that ask all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/mode_t/motion_pixels.hpp"
#include "pipeline/decode/motion/motion_images.hpp"
#include "pipeline/decode/motion/motion_samples.hpp"
#include "pipeline/decode/phase/grid_rows.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kWidth = 173, kHeight = 91;

std::vector<float> random_values(std::size_t count, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> values(-2, 2);
  std::vector<float> out(count);
  for (float& x : out) x = values(rng);
  return out;
}

Map<float> random_map(unsigned seed) {
  Map<float> map(kWidth, kHeight);
  const auto values = random_values(map.size(), seed);
  std::copy(values.begin(), values.end(), map.pixels().begin());
  return map;
}

/// The formula of grid_rows.hpp, pixel by pixel.
float bilinear(const Grid& g, int u, int v) {
  const auto place = [&](int pixel, int nodes) {
    return std::clamp((static_cast<float>(pixel) + 0.5F) / static_cast<float>(g.cell_px) - 0.5F, 0.0F,
                      static_cast<float>(nodes - 1));
  };
  const float x = place(u, g.columns), y = place(v, g.rows);
  const int left = std::min(static_cast<int>(x), std::max(g.columns - 2, 0)), right = std::min(left + 1, g.columns - 1);
  const int above = std::min(static_cast<int>(y), std::max(g.rows - 2, 0)), below = std::min(above + 1, g.rows - 1);
  const auto along = [&](int row) {
    const float a = g.nodes[row * g.columns + left], b = g.nodes[row * g.columns + right];
    return a + (b - a) * (x - static_cast<float>(left));
  };
  const float high = along(above), low = along(below);
  return high + (low - high) * (y - static_cast<float>(above));
}

TEST(SparseRows, a_grid_is_bilinear_whatever_its_cells) {
  for (const int cell : {4, 8, 12, 32, 64}) {
    const int columns = kWidth / cell, rows = kHeight / cell;
    const auto nodes = random_values(static_cast<std::size_t>(columns * rows), 1);
    const Grid grid{nodes.data(), columns, rows, cell};
    GridRows all(grid, kWidth);
    for (int v = 0; v < kHeight; ++v) {
      const float* row = all.row(v);
      for (int u = 0; u < kWidth; ++u) ASSERT_NEAR(row[u], bilinear(grid, u, v), 2e-5F) << cell << ' ' << u << ' ' << v;
    }
  }
}

TEST(SparseRows, every_second_column_of_a_grid_has_the_bits_of_all_columns) {
  for (const int cell : {4, 8, 12, 32, 64}) {
    const int columns = kWidth / cell + 1, rows = kHeight / cell + 1;
    const auto nodes = random_values(static_cast<std::size_t>(columns * rows), 2);
    const Grid grid{nodes.data(), columns, rows, cell};
    for (const std::size_t first : {0U, 1U}) {
      GridRows all(grid, kWidth), some(grid, kWidth, {first, 2});
      for (int v = 0; v < kHeight; ++v) {
        const float *every = all.row(v), *second = some.row(v);
        for (std::size_t k = 0; first + 2 * k < kWidth; ++k) ASSERT_EQ(second[k], every[first + 2 * k]) << cell;
      }
    }
  }
}

TEST(SparseRows, sampled_pixels_are_those_of_the_maps) {
  PhaseMaps maps;
  maps.resize(kWidth, kHeight);
  maps.cosine_dn = random_map(3), maps.sine_dn = random_map(4), maps.code_dn = random_map(5);
  maps.mean_dn = random_map(6), maps.phase_rad = random_map(7), maps.modulation_dn = random_map(8);
  for (std::size_t i = 0; i < maps.reject.size(); ++i)
    maps.reject[i] = i % 5 == 0 ? PixelReject::kDark : PixelReject::kNone;
  PolarityMaps polarity;
  polarity.weight = random_map(9);
  MotionSamples samples;
  place_samples(kWidth, kHeight, samples);
  SampledPixels pixels;
  pixels.take(maps, polarity, samples);
  std::size_t seen = 0;
  for (int v = 0; v < kHeight; v += kPixelStep) {
    const SampledRow row = pixels.row(v);
    std::size_t k = 0;
    for (const std::int32_t node : nodes_of_row(samples, kWidth / kNode_px, v / kNode_px)) {
      for (int j = 0; j < kNode_px / kPixelStep; ++j, ++k) {
        const int u = node % (kWidth / kNode_px) * kNode_px + first_column(v) + j * kPixelStep;
        EXPECT_EQ(row.cosine[k], maps.cosine_dn(u, v));
        EXPECT_EQ(row.sine[k], maps.sine_dn(u, v));
        EXPECT_EQ(row.code[k], maps.code_dn(u, v));
        EXPECT_EQ(row.mean[k], maps.mean_dn(u, v));
        EXPECT_EQ(row.phase[k], maps.phase_rad(u, v));
        EXPECT_EQ(row.weight[k], polarity.weight(u, v));
        EXPECT_EQ(row.modulation[k], maps.modulation_dn(u, v));
        EXPECT_EQ(row.open[k], maps.reject(u, v) == PixelReject::kNone ? 1.0F : 0.0F);
      }
    }
    EXPECT_EQ(row.count, k);
    seen += k;
  }
  EXPECT_EQ(seen, kNodePixels * samples.node.size());
}

}  // namespace
}  // namespace enamel::pipeline
