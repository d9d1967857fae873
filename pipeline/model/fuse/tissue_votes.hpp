// What bursts say of the tissue in a block: how bright it is, and whether it keeps its place. Teeth are bright and
// stay; gum is dark and stays; tongue and cheek are dark and move.
#pragma once

#include <cstdint>

#include "pipeline/model/fuse/block_grid.hpp"
#include "pipeline/model/fuse/integrate_block.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

/// Beside noise: so far are poses off, one standard deviation, mm. chosen: a tenth of FreeSpaceConfig::through_mm.
inline constexpr float kPoseSigma_mm = 0.03F;

/// The burst's shade where it saw the block's middle, and whether what it measured there lies more than three standard
/// deviations from the surface that the block has. To be asked before the burst is fused into the block. Nothing
/// happens with a patch that has no shade: plaster.
void note_tissue(const SurfelMap& surfels, const SurfacePatch& patch, const BlockInCamera& at, double voxel_mm,
                 Block& block);

/// The burst looked through the block to something well behind it.
void note_looked_through(Block& block);

/// More than half of at least four bursts did not find the block's surface where others had. A block's place moves by
/// noise with one burst in four hundred.
[[nodiscard]] bool keeps_moving(const BlockTissue& tissue) noexcept;

/// Whether the surface at a voxel (fractions allowed, 0 … 8) of the block is soft tissue's: shades of the blocks about
/// it, by their distance, are below the limit, or the block has a shade and keeps moving.
[[nodiscard]] bool is_soft_at(const BlockGrid& grid, const Block& block, const Vec3f& voxel,
                              std::uint8_t soft_below) noexcept;

}  // namespace enamel::pipeline
