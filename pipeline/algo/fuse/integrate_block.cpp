#include "pipeline/algo/fuse/integrate_block.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace enamel::algo {
namespace {

// Eight voxels along x: camera coordinates and the pixel each falls on.
struct Row {
  alignas(16) std::array<float, kBlockEdge> x, y, z;
  alignas(16) std::array<std::int32_t, kBlockEdge> u, v;
};

void project_row(const Vec3f& start, const Vec3f& step, const LocalProjection& local, Row& row) {
  for (std::size_t i = 0; i < kBlockEdge; ++i) {
    const auto k = static_cast<float>(static_cast<std::int32_t>(i));
    row.x[i] = start.x() + k * step.x();
    row.y[i] = start.y() + k * step.y();
    row.z[i] = start.z() + k * step.z();
    const float inverse = 1.0F / row.z[i];
    // + 1 before the truncation: rounds to the nearest pixel for values above -1.5, what lies below is outside anyway.
    row.u[i] = static_cast<std::int32_t>((local.u0 + (local.uX * row.x[i] + local.uY * row.y[i]) * inverse) + 1.5F) - 1;
    row.v[i] = static_cast<std::int32_t>((local.v0 + (local.vX * row.x[i] + local.vY * row.y[i]) * inverse) + 1.5F) - 1;
  }
}

struct Limits {
  float truncation, full_weight_depth, fade, weight_max;
  int min_observations, min_bursts;
};

Limits limits_of(const FuseConfig& config) {
  const auto truncation = static_cast<float>(config.voxel_mm * config.truncation_voxels);
  const auto voxel = static_cast<float>(config.voxel_mm);
  // Behind the surface the weight fades from one voxel's depth on: what lies there may belong to the other side.
  return {truncation,
          -voxel,
          1.0F / std::max(truncation - voxel, 0.1F * voxel),
          static_cast<float>(config.voxel_weight_max),
          config.min_observations,
          config.min_bursts};
}

// One measurement into one voxel. `moved` collects how far the zero crossing may have shifted.
inline void update_voxel(Block& block, std::size_t i, float distance, float weight, std::uint32_t support,
                         const Limits& limits, float& moved) noexcept {
  const float old_weight = block.weight[i];
  const float old_distance = block.distance_mm[i];
  const float sum = old_weight + weight;
  const float change = (distance - old_distance) * (weight / sum);
  block.distance_mm[i] = old_distance + change;
  block.weight[i] = std::min(sum, limits.weight_max);
  const bool was_surface = block.observations[i] >= limits.min_observations && block.bursts[i] >= limits.min_bursts;
  block.observations[i] = static_cast<std::uint8_t>(std::min<std::uint32_t>(255U, block.observations[i] + support));
  block.bursts[i] = static_cast<std::uint8_t>(std::min(255, block.bursts[i] + 1));
  const bool is_surface = block.observations[i] >= limits.min_observations && block.bursts[i] >= limits.min_bursts;
  block.grown = block.grown || (is_surface && !was_surface);
  block.confirmed = block.confirmed || is_surface;
  moved = std::max(moved, std::fabs(change));
}

}  // namespace

std::uint64_t integrate_block(const SurfelMap& surfels, const BlockInCamera& at, const FuseConfig& config,
                              Block& block) {
  const Limits limits = limits_of(config);
  const auto width = static_cast<std::uint32_t>(surfels.width());
  const auto height = static_cast<std::uint32_t>(surfels.height());
  std::uint64_t updated = 0;
  float moved = 0.0F;
  Row row;
  for (std::size_t line = 0; line < kBlockEdge * kBlockEdge; ++line) {
    const auto ky = static_cast<float>(static_cast<std::int32_t>(line % kBlockEdge));
    const auto kz = static_cast<float>(static_cast<std::int32_t>(line / kBlockEdge));
    const Vec3f start(at.origin.x() + ky * at.step_y.x() + kz * at.step_z.x(),
                      at.origin.y() + ky * at.step_y.y() + kz * at.step_z.y(),
                      at.origin.z() + ky * at.step_y.z() + kz * at.step_z.z());
    project_row(start, at.step_x, at.projection, row);
    for (std::size_t i = 0; i < kBlockEdge; ++i) {
      const auto u = static_cast<std::uint32_t>(row.u[i]);
      const auto v = static_cast<std::uint32_t>(row.v[i]);
      if (u >= width || v >= height) {
        continue;
      }
      const Surfel& s = surfels[static_cast<std::size_t>(v) * width + u];
      const float distance = ((s.nx * row.x[i] + s.ny * row.y[i]) + s.nz * row.z[i]) - s.offset_mm;
      if (!(s.weight > 0.0F) || distance > limits.truncation || distance <= -limits.truncation) {
        continue;
      }
      const float weight =
          distance >= limits.full_weight_depth ? s.weight : s.weight * ((limits.truncation + distance) * limits.fade);
      if (weight > 0.0F) {
        update_voxel(block, line * kBlockEdge + i, distance, weight, s.support, limits, moved);
        ++updated;
      }
    }
  }
  block.moved_mm += moved;
  return updated;
}

}  // namespace enamel::algo
