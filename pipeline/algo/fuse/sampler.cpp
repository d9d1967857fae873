#include "pipeline/algo/fuse/sampler.hpp"

#include <cmath>

namespace enamel::algo {
namespace {

constexpr double kBias = static_cast<double>(kBlockRange) * kBlockEdge;

inline float mix(float a, float b, float t) noexcept { return a + t * (b - a); }

inline std::size_t voxel_index(int x, int y, int z) noexcept { return static_cast<std::size_t>(x + 8 * y + 64 * z); }

}  // namespace

bool Sampler::locate(const Vec3d& at, Cell& cell) {
  if (!(at.cwiseAbs().maxCoeff() < kBias - kBlockEdge)) {
    return false;
  }
  BlockIndex index{};
  for (int k = 0; k < 3; ++k) {
    // Truncation of a positive number is its floor, without a library call.
    const auto lower = static_cast<std::int32_t>(at[k] + kBias) - static_cast<std::int32_t>(kBias);
    const auto axis = static_cast<std::size_t>(k);
    index[axis] = lower >> 3;
    cell.local[axis] = lower & 7;
    cell.part[axis] = static_cast<float>(at[k] - lower);
  }
  if (block_ != nullptr && block_->index == index) {
    return true;
  }
  const std::int32_t id = grid_.find(index);
  block_ = id == kNoBlock ? nullptr : &grid_.block(id);
  return block_ != nullptr;
}

bool Sampler::voxel(int x, int y, int z, float& value) const {
  const Block* block = block_;
  if (((x | y | z) & ~7) != 0) {
    const int at = ((x >> 3) + 1) + 3 * ((y >> 3) + 1) + 9 * ((z >> 3) + 1);
    const std::int32_t id = block_->neighbour[static_cast<std::size_t>(at)];
    if (id == kNoBlock) {
      return false;
    }
    block = &grid_.block(id);
  }
  const std::size_t i = voxel_index(x & 7, y & 7, z & 7);
  value = block->distance_mm[i];
  return block->weight[i] > 0.0F;
}

bool Sampler::corners(const Cell& cell, std::array<float, 8>& value) const {
  const auto [x, y, z] = cell.local;
  if (x < 7 && y < 7 && z < 7) {
    bool ok = true;
    const std::size_t base = voxel_index(x, y, z);
    constexpr std::array<std::size_t, 8> kOffset{0, 1, 8, 9, 64, 65, 72, 73};
    for (std::size_t c = 0; c < 8; ++c) {
      value[c] = block_->distance_mm[base + kOffset[c]];
      ok = ok && block_->weight[base + kOffset[c]] > 0.0F;
    }
    return ok;
  }
  for (std::size_t c = 0; c < 8; ++c) {
    const int corner = static_cast<int>(c);
    if (!voxel(x + (corner & 1), y + ((corner >> 1) & 1), z + (corner >> 2), value[c])) {
      return false;
    }
  }
  return true;
}

bool Sampler::sample(const Vec3d& at, float& distance_mm, Vec3f& gradient) {
  Cell cell;
  std::array<float, 8> f{};
  if (!locate(at, cell) || !corners(cell, f)) {
    return false;
  }
  const auto [tx, ty, tz] = cell.part;
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

bool Sampler::smooth_gradient(const Vec3d& at, Vec3f& gradient) {
  Cell cell;
  if (!locate(at, cell)) {
    return false;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t side1 = (axis + 1) % 3;
    const std::size_t side2 = (axis + 2) % 3;
    std::array<float, 4> slope{};
    for (std::size_t c = 0; c < 4; ++c) {
      std::array<int, 3> at_voxel = cell.local;
      at_voxel[side1] += static_cast<int>(c & 1U);
      at_voxel[side2] += static_cast<int>(c >> 1U);
      std::array<float, 4> f{};
      for (std::size_t k = 0; k < 4; ++k) {
        std::array<int, 3> q = at_voxel;
        q[axis] += static_cast<int>(k) - 1;
        if (!voxel(q[0], q[1], q[2], f[k])) {
          return false;
        }
      }
      slope[c] = 0.5F * mix(f[2] - f[0], f[3] - f[1], cell.part[axis]);
    }
    gradient[static_cast<int>(axis)] =
        mix(mix(slope[0], slope[1], cell.part[side1]), mix(slope[2], slope[3], cell.part[side1]), cell.part[side2]);
  }
  return true;
}

}  // namespace enamel::algo
