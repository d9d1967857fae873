// Trilinear interpolation of the distance field and its gradient. In the header: the inner loop of a view.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "pipeline/model/fuse/block_grid.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// Positions are in voxels (model coordinates / voxel_mm); in single precision a voxel of 0.1 mm, 100 mm from the
/// origin, is told to 6 nm. Remembers the last block: neighbouring queries are cheap.
/// Not thread-safe; make one a thread.
class Sampler {
 public:
  explicit Sampler(const BlockGrid& grid) : grid_(grid) {}

  /// Interpolated distance (mm) and the gradient of the interpolant (mm a voxel). False where one of the eight voxels
  /// is unobserved.
  bool sample(const Vec3f& at, float& distance_mm, Vec3f& gradient) {
    std::array<float, 8> f;
    if (!locate(at) || !corners(f)) return false;
    const auto [tx, ty, tz] = part_;
    const float x00 = mix(f[0], f[1], tx);
    const float x10 = mix(f[2], f[3], tx);
    const float x01 = mix(f[4], f[5], tx);
    const float x11 = mix(f[6], f[7], tx);
    const float y0 = mix(x00, x10, ty);
    const float y1 = mix(x01, x11, ty);
    distance_mm = mix(y0, y1, tz);
    gradient.x() = mix(mix(f[1] - f[0], f[3] - f[2], ty), mix(f[5] - f[4], f[7] - f[6], ty), tz);
    gradient.y() = mix(x10 - x00, x11 - x01, tz);
    gradient.z() = y1 - y0;
    return true;
  }

  /// By how much (mm) the interpolant lies above a field with the curvature of the voxels around: t (1 - t)/2 times the
  /// second difference, summed over the axes. Axes along which a neighbour is unobserved add nothing.
  float excess_mm(const Vec3f& at) {
    if (!locate(at)) return 0;
    std::array<int, 3> nearest = local_;
    for (std::size_t k = 0; k < 3; ++k) nearest[k] += part_[k] > 0.5F ? 1 : 0;
    float here = 0, sum = 0;
    if (!voxel(nearest[0], nearest[1], nearest[2], here)) return 0;
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<int, 3> before = nearest, after = nearest;
      --before[k], ++after[k];
      float low = 0, high = 0;
      if (!voxel(before[0], before[1], before[2], low) || !voxel(after[0], after[1], after[2], high)) continue;
      sum += 0.5F * part_[k] * (1 - part_[k]) * ((low + high) - 2 * here);
    }
    return sum;
  }

  /// How far along o + s d (voxels) the last sample's place without a block reaches, by s and with a margin; -infinity
  /// where that had a block. Only for a last sample on that ray.
  [[nodiscard]] float void_until(const Vec3f& origin, const Vec3f& direction) const {
    if (block_ != nullptr || index_ == kNowhere) return -std::numeric_limits<float>::infinity();
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      const bool up = direction[axis] > 0;
      const float bound = static_cast<float>((index_[k] + (up ? 1 : 0)) * kBlockEdge);
      // derived: rounding of a position is a millionth of it at most.
      const float margin = 1e-2F + 1e-6F * std::fabs(bound);
      const float beyond = (up ? bound - margin : bound + margin) - origin[axis];
      if (direction[axis] != 0) least = std::min(least, beyond / direction[axis]);
    }
    return least;
  }

 private:
  static float mix(float a, float b, float t) noexcept { return a + t * (b - a); }

  /// Finds the block, the lower corner within it and the position beyond that. False where there is no block.
  bool locate(const Vec3f& at) {
    constexpr float kLimit = static_cast<float>(kBlockRange - 1) * kBlockEdge;
    if (!(std::fabs(at.x()) < kLimit && std::fabs(at.y()) < kLimit && std::fabs(at.z()) < kLimit)) {
      index_ = kNowhere;
      block_ = nullptr;
      return false;
    }
    BlockIndex index;
    for (std::size_t k = 0; k < 3; ++k) {
      const float x = at[static_cast<Eigen::Index>(k)];
      auto lower = static_cast<std::int32_t>(x);
      lower -= static_cast<float>(lower) > x ? 1 : 0;
      index[k] = lower >> 3;
      local_[k] = lower & (kBlockEdge - 1);
      part_[k] = x - static_cast<float>(lower);
    }
    if (index != index_) {
      const std::int32_t id = id_of(index);
      index_ = index;
      block_ = id == kNoBlock ? nullptr : &grid_.block(id);
    }
    return block_ != nullptr;
  }

  /// By the last block's links where that is a neighbour.
  [[nodiscard]] std::int32_t id_of(const BlockIndex& index) const {
    if (block_ != nullptr) {
      const int dx = index[0] - index_[0], dy = index[1] - index_[1], dz = index[2] - index_[2];
      if (std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) <= 1) {
        return block_->neighbour[neighbour_index(dx, dy, dz)];
      }
    }
    return grid_.find(index);
  }

  bool corners(std::array<float, 8>& value) const {
    const auto [x, y, z] = local_;
    if (x < kBlockEdge - 1 && y < kBlockEdge - 1 && z < kBlockEdge - 1) {
      const std::size_t base = voxel_index(x, y, z);
      constexpr std::array<std::size_t, 8> kOffset{0, 1, 8, 9, 64, 65, 72, 73};
      bool ok = true;
      for (std::size_t c = 0; c < 8; ++c) {
        value[c] = block_->distance_mm[base + kOffset[c]];
        ok = ok & (block_->weight[base + kOffset[c]] > 0.0F);
      }
      return ok;
    }
    for (std::size_t c = 0; c < 8; ++c) {
      const int corner = static_cast<int>(c);
      if (!voxel(x + (corner & 1), y + ((corner >> 1) & 1), z + (corner >> 2), value[c])) return false;
    }
    return true;
  }

  /// Voxel at an offset from the current block's first voxel, each -8 … 15. False if unobserved.
  bool voxel(int x, int y, int z, float& value) const {
    const Block* block = block_;
    if (((x | y | z) & ~7) != 0) {
      const std::int32_t id = block_->neighbour[neighbour_index(x >> 3, y >> 3, z >> 3)];
      if (id == kNoBlock) return false;
      block = &grid_.block(id);
    }
    const std::size_t i = voxel_index(x & 7, y & 7, z & 7);
    value = block->distance_mm[i];
    return block->weight[i] > 0.0F;
  }

  const BlockGrid& grid_;
  const Block* block_ = nullptr;
  static constexpr BlockIndex kNowhere{kBlockRange, kBlockRange, kBlockRange};
  BlockIndex index_ = kNowhere;  ///< of the block last looked up
  std::array<int, 3> local_{};   ///< lower corner within the block, 0 … 7
  std::array<float, 3> part_{};  ///< position between lower and upper corner, 0 … 1
};

}  // namespace enamel::pipeline
