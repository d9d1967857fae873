// Which blocks of the model must go to the GPU now. Blocks are shared between snapshots, so a changed block is another
// pointer; within one frame no more than a budget of bytes is sent, the rest follows in the next frames.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "pipeline/types/model_snapshot.hpp"

namespace enamel::view {

using BlockIndex = std::array<std::int32_t, 3>;

/// What one vertex and one triangle cost on the GPU: 3 floats position, 4 shorts normal and quality; 3 indices.
inline constexpr std::size_t kGpuVertexBytes = 20;
inline constexpr std::size_t kGpuTriangleBytes = 12;

[[nodiscard]] std::size_t gpu_bytes(const BlockMesh& block) noexcept;

/// Vertices, normals and quality agree in number (normals and quality may be absent) and indices stay in range.
[[nodiscard]] bool well_formed(const BlockMesh& block) noexcept;

struct UploadPlan {
  std::vector<std::shared_ptr<const BlockMesh>> upload;  ///< new or changed, within the budget (at least one if any)
  std::vector<BlockIndex> remove;                        ///< on the GPU but no longer in the model
  std::size_t pending = 0;                               ///< changed blocks left for later
};

/// Remembers what was sent. Not thread-safe.
class MeshDiff {
 public:
  /// Plans and counts as sent. Blocks take turns: a budget that is too small delays blocks but starves none. A null or
  /// malformed block is skipped and keeps its predecessor.
  [[nodiscard]] UploadPlan plan(const ModelSnapshot& model, std::size_t budget_bytes);
  void clear() { sent_.clear(); }
  [[nodiscard]] std::size_t blocks() const noexcept { return sent_.size(); }

 private:
  [[nodiscard]] std::vector<BlockIndex> drop_vanished(const ModelSnapshot& model);

  std::map<BlockIndex, std::shared_ptr<const BlockMesh>> sent_;  ///< holding the pointer keeps its address from reuse
  BlockIndex next_{};                                            ///< where the next turn begins
};

}  // namespace enamel::view
