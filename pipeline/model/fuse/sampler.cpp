#include "pipeline/model/fuse/sampler.hpp"

#include <cmath>

namespace enamel::pipeline {
namespace {

constexpr double kBias = static_cast<double>(kBlockRange) * kBlockEdge;

inline float mix(float a, float b, float t) noexcept { return a + t * (b - a); }

}  // namespace

bool Sampler::locate(const Vec3d& at, Cell& cell) {
  constexpr double kLimit = kBias - kBlockEdge;
  if (!(std::fabs(at.x()) < kLimit && std::fabs(at.y()) < kLimit && std::fabs(at.z()) < kLimit)) {
    return false;
  }
  std::array<std::uint32_t, 3> biased{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double shifted = at[static_cast<int>(k)] + kBias;
    const auto lower = static_cast<std::int32_t>(shifted);  // truncation of a positive number is its floor
    biased[k] = static_cast<std::uint32_t>(lower) >> 3U;
    cell.local[k] = lower & 7;
    cell.part[k] = static_cast<float>(shifted - lower);
  }
  const std::uint64_t key = biased[0] | (std::uint64_t{biased[1]} << 21U) | (std::uint64_t{biased[2]} << 42U);
  if (key != key_) {
    key_ = key;
    const auto index = [](std::uint32_t b) { return static_cast<std::int32_t>(b) - kBlockRange; };
    const std::int32_t id = grid_.find({index(biased[0]), index(biased[1]), index(biased[2])});
    block_ = id == kNoBlock ? nullptr : &grid_.block(id);
  }
  return block_ != nullptr;
}

bool Sampler::voxel(int x, int y, int z, float& value) const {
  const Block* block = block_;
  if (((x | y | z) & ~7) != 0) {
    const std::int32_t id = block_->neighbour[neighbour_index(x >> 3, y >> 3, z >> 3)];
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

float Sampler::excess_mm(const Vec3d& at) {
  Cell cell;
  if (!locate(at, cell)) return 0;
  std::array<int, 3> nearest = cell.local;
  for (std::size_t k = 0; k < 3; ++k) nearest[k] += cell.part[k] > 0.5F ? 1 : 0;
  float here = 0, sum = 0;
  if (!voxel(nearest[0], nearest[1], nearest[2], here)) return 0;
  for (std::size_t k = 0; k < 3; ++k) {
    std::array<int, 3> before = nearest, after = nearest;
    --before[k], ++after[k];
    float low = 0, high = 0;
    if (!voxel(before[0], before[1], before[2], low) || !voxel(after[0], after[1], after[2], high)) continue;
    sum += 0.5F * cell.part[k] * (1 - cell.part[k]) * ((low + high) - 2 * here);
  }
  return sum;
}

}  // namespace enamel::pipeline
