// Free space against surface that counts already: a burst that looks through a block to what lies behind it speaks
// against the block; enough such bursts for each moment that it was seen in, and it goes.
#pragma once

#include "pipeline/model/fuse/block_grid.hpp"
#include "pipeline/model/fuse/integrate_block.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

/// Bursts further apart than this saw a block in different moments: what passes is there for one.
inline constexpr std::uint64_t kMomentBursts = 16;

/// Notes that the burst measured voxels of the block.
void note_measured(Block& block, std::uint64_t burst);

/// Whether the patch was measured well behind what the block has of the inside of its surface. Inside, for what lies
/// just outside a steep wall is seen through from above and belongs to it all the same.
[[nodiscard]] bool looks_through(const SurfelMap& surfels, const SurfacePatch& patch, const BlockInCamera& at,
                                 double margin_mm, const Block& block);

}  // namespace enamel::pipeline
