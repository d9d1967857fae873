// Sparse grid of 8x8x8-voxel blocks: dense storage in order of allocation, a hash for lookup only, links to the 26
// neighbours. Voxel (x, y, z) has its centre at (x, y, z) * voxel_mm; block index = floor(voxel / 8). Not thread-safe
// while it grows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace enamel::pipeline {

using BlockIndex = std::array<std::int32_t, 3>;

inline constexpr int kBlockEdge = 8;
inline constexpr int kBlockVoxels = kBlockEdge * kBlockEdge * kBlockEdge;
inline constexpr std::int32_t kNoBlock = -1;
/// Block indices lie in [-kBlockRange, kBlockRange).
inline constexpr std::int32_t kBlockRange = 1 << 20;

/// Voxel (x, y, z) of a block, 0 … 7 each.
[[nodiscard]] constexpr std::size_t voxel_index(int x, int y, int z) noexcept {
  const int i = x + 8 * y + 64 * z;
  return static_cast<std::size_t>(i);
}

/// Element of Block::neighbour for the block at an offset of -1, 0 or 1 along each axis.
[[nodiscard]] constexpr std::size_t neighbour_index(int dx, int dy, int dz) noexcept {
  const int i = (dx + 1) + 3 * (dy + 1) + 9 * (dz + 1);
  return static_cast<std::size_t>(i);
}

/// tissue_votes.hpp: all 0 while nothing but plaster was seen.
struct BlockTissue {
  std::uint32_t shade_sum = 0;         ///< of so many bursts that saw its middle: …
  std::uint16_t shaded = 0;            ///< … saturating
  std::uint16_t asked = 0, moved = 0;  ///< bursts that met its surface, and that did not find it in its place
};

struct Block {
  BlockIndex index{};
  std::array<std::int32_t, 27> neighbour{};  ///< ids by neighbour_index; itself in the middle
  std::array<float, kBlockVoxels>
      distance_mm{};                         ///< weighted mean signed distance, positive outside; 0 where weight is 0
  std::array<float, kBlockVoxels> weight{};  ///< 0 = never observed
  std::array<std::uint8_t, kBlockVoxels> observations{};          ///< pixel measurements, saturating
  std::array<std::uint8_t, kBlockVoxels> bursts{};                ///< bursts, saturating
  std::uint64_t first_burst = ~std::uint64_t{0}, last_burst = 0;  ///< of those that measured it; first > last: none did
  std::uint8_t moments = 0;  ///< apart in time, in which it was measured; saturating
  std::uint8_t against = 0;  ///< bursts that looked through it since it was last measured; saturating
  BlockTissue tissue = {};
  std::uint64_t touched_by = 0;  ///< serial number of the last integration that visited it
  float moved_mm = 0;            ///< how far its surface may have moved since it was last taken for meshing
  bool grown = false;            ///< voxels became surface (or ceased to be) since it was last taken
  bool pending = false;          ///< on the model's list of changed blocks
  bool confirmed = false;        ///< holds at least one voxel that counts as surface
};

class BlockGrid {
 public:
  BlockGrid();

  /// Id of the block or kNoBlock. Ids count up from 0 in order of allocation and stay valid.
  [[nodiscard]] std::int32_t find(const BlockIndex& index) const noexcept;
  /// Existing or new (unobserved) block. The index must lie in range.
  std::int32_t allocate(const BlockIndex& index);

  [[nodiscard]] std::size_t size() const noexcept { return indices_.size(); }
  [[nodiscard]] Block& block(std::int32_t id) noexcept {
    const auto at = static_cast<std::size_t>(id);
    return slabs_[at / kSlab][at % kSlab];
  }
  [[nodiscard]] const Block& block(std::int32_t id) const noexcept {
    const auto at = static_cast<std::size_t>(id);
    return slabs_[at / kSlab][at % kSlab];
  }

  [[nodiscard]] const BlockIndex& index_of(std::int32_t id) const noexcept {
    return indices_[static_cast<std::size_t>(id)];
  }

  [[nodiscard]] static bool in_range(const BlockIndex& index) noexcept;

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::int32_t id = kNoBlock;
  };
  void insert(std::uint64_t key, std::int32_t id) noexcept;
  void grow();
  void link(std::int32_t id);

  static constexpr std::size_t kSlab = 64;  ///< blocks allocated at once; chosen: a third of a megabyte
  std::vector<std::unique_ptr<Block[]>> slabs_;
  std::vector<BlockIndex> indices_;  ///< of the blocks, close together: a walk over all of them is cheap
  std::vector<Slot> slots_;          ///< open addressing, power of two, at most half full
};

}  // namespace enamel::pipeline
