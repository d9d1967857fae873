// The model's surface kept up to date block by block.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "pipeline/algo/mesh/mesh_block.hpp"
#include "pipeline/algo/mesh/mesh_config.hpp"
#include "pipeline/types/mesh.hpp"
#include "pipeline/types/model_snapshot.hpp"

namespace enamel::algo {

struct UpdateStats {
  std::uint32_t blocks_meshed = 0;
  std::uint32_t blocks_with_surface = 0;  ///< of those
};

struct ExtractStats {
  std::uint32_t components = 0;
  std::uint32_t components_removed = 0;  ///< smaller than MeshConfig::min_component_triangles
  std::uint64_t triangles_removed = 0;
};

/// Not thread-safe; update() reads the model, so the model must not change meanwhile. Published blocks are immutable.
class IncrementalMesher {
 public:
  explicit IncrementalMesher(const MeshConfig& config = {}) : config_(config), mesher_(config) {}

  /// Meshes the changed blocks (TsdfModel::take_changed) and their neighbours (cells and normals reach across) anew.
  UpdateStats update(const TsdfModel& model, std::span<const BlockIndex> changed);

  /// What the viewer takes; blocks that did not change are shared with earlier snapshots.
  [[nodiscard]] ModelSnapshot snapshot() const;

  /// One indexed mesh: vertices on the same grid edge are one vertex, so inside the seen surface every edge has exactly
  /// two triangles; floating pieces are removed. Order follows block index. All changes must have been given to
  /// update() before (take_changed(0)), else neighbouring blocks may differ in age.
  [[nodiscard]] Mesh extract(ExtractStats* stats = nullptr) const;

 private:
  struct Entry {
    std::shared_ptr<const BlockMesh> mesh;
    std::vector<std::uint64_t> edge_keys;
  };
  MeshConfig config_;
  BlockMesher mesher_;
  std::map<BlockIndex, Entry> blocks_;  ///< those with triangles
  std::uint64_t after_burst_ = 0;
};

}  // namespace enamel::algo
