// The interpolated distance field of a ball against the ball itself.
#include "pipeline/model/fuse/sampler.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/model/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kVoxel_mm = 0.1, kRadius_mm = 2.5, kBand_mm = 0.4;
constexpr int kBlocks = 4;  ///< from the middle to the end of the grid, along each axis

/// Exact distances from a ball about the origin, observed within a band about its surface.
BlockGrid ball() {
  BlockGrid grid;
  for (int x = -kBlocks; x < kBlocks; ++x) {
    for (int y = -kBlocks; y < kBlocks; ++y) {
      for (int z = -kBlocks; z < kBlocks; ++z) {
        Block& block = grid.block(grid.allocate({x, y, z}));
        for (int i = 0; i < kBlockVoxels; ++i) {
          const int dx = i % 8, dy = i / 8 % 8, dz = i / 64;
          const Vec3d at(8 * x + dx, 8 * y + dy, 8 * z + dz);
          const double d = kVoxel_mm * at.norm() - kRadius_mm;
          const auto k = static_cast<std::size_t>(i);
          block.distance_mm[k] = static_cast<float>(d);
          block.weight[k] = std::abs(d) < kBand_mm ? 1.0F : 0.0F;
        }
      }
    }
  }
  return grid;
}

TEST(Sampler, excess_is_what_interpolation_adds_to_a_curved_surface) {
  const BlockGrid grid = ball();
  Sampler sampler(grid);
  synthetic::Random random(5);
  double as_is_um = 0, less_excess_um = 0;
  constexpr int kPoints = 20'000;
  for (int k = 0; k < kPoints; ++k) {
    const Vec3f on_ball = (kRadius_mm / kVoxel_mm * random.vector().normalized()).cast<float>();
    float distance_mm = 0;
    Vec3f gradient;
    ASSERT_TRUE(sampler.sample(on_ball, distance_mm, gradient));
    as_is_um += 1e3 * static_cast<double>(distance_mm) / kPoints;
    less_excess_um += 1e3 * static_cast<double>(distance_mm - sampler.excess_mm(on_ball)) / kPoints;
  }
  const double expected_um =
      1e3 * kVoxel_mm * kVoxel_mm / (6 * kRadius_mm);  // two curvatures, t (1 - t)/2 on average 1/12
  EXPECT_NEAR(as_is_um, expected_um, 0.05 * expected_um) << "negative control: left in";
  EXPECT_LT(std::abs(less_excess_um), 0.02);
}

TEST(Sampler, excess_is_nothing_where_neighbours_were_not_seen) {
  BlockGrid grid;
  Block& block = grid.block(grid.allocate({0, 0, 0}));
  block.weight[voxel_index(3, 3, 3)] = 1;
  Sampler sampler(grid);
  EXPECT_EQ(sampler.excess_mm({3.2F, 3.3F, 3.1F}), 0.0F);
  EXPECT_EQ(sampler.excess_mm({30, 3, 3}), 0.0F);
}

}  // namespace
}  // namespace enamel::pipeline
