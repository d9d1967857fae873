// Weighted running mean of one patch's distances in the voxels of one block.
#pragma once

#include <cstdint>

#include "pipeline/model/fuse/block_grid.hpp"
#include "pipeline/model/fuse/projection.hpp"
#include "pipeline/model/fuse/surfel_map.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// Voxel (x, y, z) of the block lies at origin + x step_x + y step_y + z step_z in camera coordinates (mm).
struct BlockInCamera {
  Vec3f origin, step_x, step_y, step_z;
  LocalProjection projection;
};

/// Returns the number of voxels updated.
std::uint64_t integrate_block(const SurfelMap& surfels, const BlockInCamera& at, const FuseConfig& config,
                              Block& block);

}  // namespace enamel::pipeline
