// The model's surface kept up to date block by block.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "pipeline/model/mesh/components.hpp"
#include "pipeline/model/mesh/mesh_block.hpp"
#include "pipeline/model/mesh/mesh_config.hpp"
#include "pipeline/types/mesh.hpp"
#include "pipeline/types/model_snapshot.hpp"

namespace enamel::pipeline {

struct UpdateStats {
  std::uint32_t blocks_meshed = 0;
  std::uint32_t blocks_with_surface = 0;  ///< of those
  std::uint32_t blocks_waiting = 0;       ///< left for the next update
};

struct ExtractStats {
  std::uint32_t components = 0;
  std::uint32_t components_removed = 0;  ///< small ones, and what passed by: MeshConfig
  std::uint64_t triangles_removed = 0;
};

/// Not thread-safe; update() reads the model, so the model must not change meanwhile. Published blocks are immutable.
class IncrementalMesher {
 public:
  explicit IncrementalMesher(const MeshConfig& config = {}) : config_(config), mesher_(config) {}

  static constexpr std::size_t kAll = ~std::size_t{0};

  /// Queues the changed blocks (TsdfModel::take_changed) and their neighbours (cells and normals reach across) and
  /// meshes the first max_blocks of the queue anew: a bounded time a burst, a preview a few bursts behind. kAll empties
  /// the queue. Where another shade than before parts soft tissue, all blocks are queued.
  UpdateStats update(const TsdfModel& model, std::span<const BlockIndex> changed, std::size_t max_blocks = kAll);

  /// What the viewer takes; blocks that did not change are shared with earlier snapshots.
  [[nodiscard]] ModelSnapshot snapshot() const;

  /// One indexed mesh: vertices on the same grid edge are one vertex, so inside the seen surface every edge has exactly
  /// two triangles; floating pieces are removed. Order follows block index. All changes must have been given to
  /// update() before (take_changed(0)), else neighbouring blocks may differ in age.
  [[nodiscard]] Mesh extract(ExtractStats* stats = nullptr) const;

 private:
  void enqueue(std::int32_t id);
  struct Entry {
    std::shared_ptr<const BlockMesh> mesh;
    std::vector<std::uint64_t> edge_keys;
    SeenSpan seen;  ///< of the block
  };
  MeshConfig config_;
  BlockMesher mesher_;
  std::map<BlockIndex, Entry> blocks_;  ///< those with triangles
  std::deque<std::int32_t> queue_;      ///< ids to mesh, first changed first
  std::vector<bool> queued_;            ///< by id
  MeshedBlock scratch_;
  std::uint64_t after_burst_ = 0;
  std::uint8_t soft_below_ = kNothingSoft;  ///< that the blocks were meshed with, but those in the queue
};

}  // namespace enamel::pipeline
