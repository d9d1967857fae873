#include "pipeline/model/fuse/integrate_block.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace enamel::pipeline {
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
  float truncation, fade, weight_max, near_surface;
  unsigned min_observations, min_bursts;
};

Limits limits_of(const FuseConfig& config) {
  const auto truncation = static_cast<float>(config.voxel_mm * config.truncation_voxels);
  const auto voxel = static_cast<float>(config.voxel_mm);
  const auto at_least_one = [](int n) { return static_cast<unsigned>(std::max(1, n)); };
  // Behind the surface the weight fades from one voxel's depth on: what lies there may belong to the other side.
  return {truncation,
          1.0F / std::max(truncation - voxel, 0.1F * voxel),
          static_cast<float>(config.voxel_weight_max),
          1.5F * voxel,
          at_least_one(config.min_observations),
          at_least_one(config.min_bursts)};
}

// What the patch says about the eight voxels; weight 0 = nothing.
struct Measured {
  alignas(16) std::array<float, kBlockEdge> distance, weight;
  std::array<std::uint8_t, kBlockEdge> support;
};

// Returns the number of voxels measured.
unsigned measure_row(const SurfelMap& surfels, const Row& row, const Limits& limits, Measured& out) noexcept {
  const auto width = static_cast<std::uint32_t>(surfels.width());
  const auto height = static_cast<std::uint32_t>(surfels.height());
  unsigned count = 0;
  for (std::size_t i = 0; i < kBlockEdge; ++i) {
    const auto u = static_cast<std::uint32_t>(row.u[i]);
    const auto v = static_cast<std::uint32_t>(row.v[i]);
    const bool inside = (u < width) & (v < height);
    const Surfel& s = surfels[inside ? static_cast<std::size_t>(v) * width + u : 0];
    const float distance = ((s.nx * row.x[i] + s.ny * row.y[i]) + s.nz * row.z[i]) - s.offset_mm;
    const float above = limits.truncation + distance;
    const bool ok = inside & (s.weight > 0.0F) & (distance <= limits.truncation) & (above > 0.0F);
    const float faded = s.weight * std::min(1.0F, above * limits.fade);
    out.distance[i] = ok ? distance : 0.0F;
    out.weight[i] = ok ? faded : 0.0F;
    out.support[i] = static_cast<std::uint8_t>(ok ? s.support : 0U);
    count += ok ? 1U : 0U;
  }
  return count;
}

// Running means of eight voxels; `moved` collects how far each zero crossing may have shifted.
void update_distances(const Measured& in, const Limits& limits, float* distance, float* weight, float* moved) noexcept {
  for (std::size_t i = 0; i < kBlockEdge; ++i) {
    const float sum = weight[i] + in.weight[i];
    const float change = (in.distance[i] - distance[i]) * (in.weight[i] / (sum > 0.0F ? sum : 1.0F));
    distance[i] += change;
    weight[i] = std::min(sum, limits.weight_max);
    moved[i] = std::max(moved[i], std::fabs(distance[i]) < limits.near_surface ? std::fabs(change) : 0.0F);
  }
}

void update_counts(const Measured& in, const Limits& limits, std::size_t first, Block& block) noexcept {
  unsigned surface = 0;
  unsigned grown = 0;
  for (std::size_t i = 0; i < kBlockEdge; ++i) {
    const unsigned seen = block.observations[first + i];
    const unsigned bursts = block.bursts[first + i];
    const unsigned seen_now = std::min(255U, seen + in.support[i]);
    const unsigned bursts_now = std::min(255U, bursts + (in.support[i] > 0 ? 1U : 0U));
    block.observations[first + i] = static_cast<std::uint8_t>(seen_now);
    block.bursts[first + i] = static_cast<std::uint8_t>(bursts_now);
    const unsigned was = (seen >= limits.min_observations ? 1U : 0U) & (bursts >= limits.min_bursts ? 1U : 0U);
    const unsigned is = (seen_now >= limits.min_observations ? 1U : 0U) & (bursts_now >= limits.min_bursts ? 1U : 0U);
    surface |= is;
    grown |= is & ~was;
  }
  block.confirmed = block.confirmed || surface != 0;
  block.grown = block.grown || grown != 0;
}

}  // namespace

std::uint64_t integrate_block(const SurfelMap& surfels, const BlockInCamera& at, const FuseConfig& config,
                              Block& block) {
  const Limits limits = limits_of(config);
  std::uint64_t updated = 0;
  std::array<float, kBlockEdge> moved{};
  Row row;
  Measured measured;
  for (std::size_t line = 0; line < kBlockEdge * kBlockEdge; ++line) {
    const auto ky = static_cast<float>(static_cast<std::int32_t>(line % kBlockEdge));
    const auto kz = static_cast<float>(static_cast<std::int32_t>(line / kBlockEdge));
    const Vec3f start(at.origin.x() + ky * at.step_y.x() + kz * at.step_z.x(),
                      at.origin.y() + ky * at.step_y.y() + kz * at.step_z.y(),
                      at.origin.z() + ky * at.step_y.z() + kz * at.step_z.z());
    project_row(start, at.step_x, at.projection, row);
    const unsigned count = measure_row(surfels, row, limits, measured);
    if (count > 0) {
      const std::size_t first = line * kBlockEdge;
      update_distances(measured, limits, &block.distance_mm[first], &block.weight[first], moved.data());
      update_counts(measured, limits, first, block);
      updated += count;
    }
  }
  block.moved_mm += *std::max_element(moved.begin(), moved.end());
  return updated;
}

}  // namespace enamel::pipeline
