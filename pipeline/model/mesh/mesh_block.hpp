// Surface triangles of one TSDF block.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/model/fuse/tsdf_model.hpp"
#include "pipeline/model/mesh/mesh_config.hpp"
#include "pipeline/types/model_snapshot.hpp"

namespace enamel::pipeline {

/// A grid edge of the whole model: block that holds its lower voxel, voxel in the block, axis. Cells of different
/// blocks that share an edge make the same vertex, bit for bit, with the same key.
[[nodiscard]] constexpr std::uint64_t edge_key(std::int32_t block_id, std::size_t voxel, std::size_t axis) noexcept {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(block_id)) << 32U) | (voxel * 3 + axis);
}

struct MeshedBlock {
  BlockMesh mesh;
  std::vector<std::uint64_t> edge_keys;  ///< one a vertex
};

/// Cells whose lowest corner lies in the block; they reach one voxel into its upper neighbours. Only cells all of whose
/// corners count as surface (TsdfModel::is_surface) are meshed. Not thread-safe: holds scratch memory.
class BlockMesher {
 public:
  explicit BlockMesher(const MeshConfig& config) : config_(config) {}
  /// Leaves out.mesh empty where the block has no surface.
  void run(const TsdfModel& model, std::int32_t block_id, MeshedBlock& out);

 private:
  static constexpr int kCorners = kBlockEdge + 1;  ///< voxels a row that cells use, 0 … 8
  static constexpr int kPadded = kBlockEdge + 3;   ///< with one more on either side for gradients, -1 … 9
  using RowMasks = std::array<std::uint16_t, static_cast<std::size_t>(kCorners) * kCorners>;

  void classify(const TsdfModel& model, const Block& block);
  [[nodiscard]] bool find_cells();
  void gather(const TsdfModel& model, const Block& block);
  void mesh_cell(const TsdfModel& model, std::int32_t block_id, int x, int y, int z, MeshedBlock& out);
  std::uint32_t vertex(const TsdfModel& model, std::int32_t block_id, const std::array<int, 3>& lower, int axis,
                       MeshedBlock& out);
  [[nodiscard]] Vec3f gradient(const std::array<int, 3>& at) const;
  [[nodiscard]] static std::size_t padded(int x, int y, int z) noexcept {
    const int i = (x + 1) + kPadded * ((y + 1) + kPadded * (z + 1));
    return static_cast<std::size_t>(i);
  }
  [[nodiscard]] static std::size_t row(int y, int z) noexcept {
    const int i = y + kCorners * z;
    return static_cast<std::size_t>(i);
  }

  MeshConfig config_;
  RowMasks inside_{}, usable_{};  ///< bit x of row (y, z)
  std::array<std::uint16_t, static_cast<std::size_t>(kBlockEdge) * kBlockEdge>
      active_{};  ///< cells that the surface cuts
  std::array<float, static_cast<std::size_t>(kPadded) * kPadded * kPadded> distance_{};  ///< NaN = unobserved
  std::array<std::int32_t, 3UL * kCorners * kCorners * kCorners> vertex_of_{};           ///< by axis and lower corner
};

}  // namespace enamel::pipeline
