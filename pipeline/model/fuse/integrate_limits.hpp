// What integrate_block takes out of the configuration, as its inner loop wants it.
#pragma once

#include <algorithm>
#include <cstdint>

#include "pipeline/model/fuse/fuse_config.hpp"
#include "pipeline/model/fuse/surfel_map.hpp"

namespace enamel::pipeline {

struct IntegrateLimits {
  float truncation, fade, weight_max, near_surface;
  std::uint8_t min_observations, min_bursts;
};

[[nodiscard]] inline IntegrateLimits limits_of(const FuseConfig& config) {
  const auto truncation = static_cast<float>(config.voxel_mm * config.truncation_voxels);
  const auto voxel = static_cast<float>(config.voxel_mm);
  const auto count = [](int n) { return static_cast<std::uint8_t>(std::clamp(n, 1, 255)); };
  // Behind the surface the weight fades from one voxel's depth on: what lies there may belong to the other side.
  return {truncation,
          1.0F / std::max(truncation - voxel, 0.1F * voxel),
          static_cast<float>(config.voxel_weight_max),
          1.5F * voxel,
          count(config.min_observations),
          count(config.min_bursts)};
}

/// Row-major, at least one surfel.
struct SurfelPicture {
  const Surfel* surfels;
  int width, height;
};

}  // namespace enamel::pipeline
