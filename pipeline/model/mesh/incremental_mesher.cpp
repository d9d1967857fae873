#include "pipeline/model/mesh/incremental_mesher.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace enamel::pipeline {

void IncrementalMesher::enqueue(std::int32_t id) {
  const auto at = static_cast<std::size_t>(id);
  if (id == kNoBlock || queued_[at]) {
    return;
  }
  queued_[at] = true;
  queue_.push_back(id);
}

UpdateStats IncrementalMesher::update(const TsdfModel& model, std::span<const BlockIndex> changed,
                                      std::size_t max_blocks) {
  UpdateStats stats;
  queued_.resize(model.grid().size(), false);
  for (const BlockIndex& index : changed) {
    const std::int32_t id = model.grid().find(index);
    if (id == kNoBlock) {
      continue;
    }
    enqueue(id);
    for (const std::int32_t near : model.grid().block(id).neighbour) {
      enqueue(near);
    }
  }
  if (model.config().soft_below != soft_below_) {
    soft_below_ = model.config().soft_below;
    for (const auto& [index, entry] : blocks_) enqueue(model.grid().find(index));
  }
  for (; !queue_.empty() && stats.blocks_meshed < max_blocks; queue_.pop_front()) {
    const std::int32_t id = queue_.front();
    queued_[static_cast<std::size_t>(id)] = false;
    ++stats.blocks_meshed;
    mesher_.run(model, id, scratch_);
    if (scratch_.mesh.triangles.empty()) {
      blocks_.erase(model.grid().block(id).index);
      continue;
    }
    ++stats.blocks_with_surface;
    Entry& entry = blocks_[scratch_.mesh.block];
    entry.edge_keys = scratch_.edge_keys;  // copies are exactly as large as needed, the scratch keeps its capacity
    entry.mesh = std::make_shared<const BlockMesh>(scratch_.mesh);
    entry.seen = {model.grid().block(id).first_burst, model.grid().block(id).last_burst};
  }
  stats.blocks_waiting = static_cast<std::uint32_t>(queue_.size());
  after_burst_ = model.after_burst();
  return stats;
}

ModelSnapshot IncrementalMesher::snapshot() const {
  ModelSnapshot snapshot;
  snapshot.after_burst = after_burst_;
  snapshot.blocks.reserve(blocks_.size());
  for (const auto& [index, entry] : blocks_) {
    snapshot.blocks.push_back(entry.mesh);
  }
  return snapshot;
}

Mesh IncrementalMesher::extract(ExtractStats* stats) const {
  Mesh mesh;
  std::unordered_map<std::uint64_t, std::uint32_t> welded;  // looked up only, never iterated
  std::vector<std::uint32_t> to;
  std::vector<SeenSpan> seen;  // of the block that a vertex is in first: pieces are many blocks large
  std::vector<std::uint8_t> soft;
  for (const auto& [index, entry] : blocks_) {
    const BlockMesh& block = *entry.mesh;
    to.clear();
    for (std::size_t i = 0; i < block.vertices.size(); ++i) {
      const auto [at, is_new] =
          welded.try_emplace(entry.edge_keys[i], static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) {
        mesh.vertices.push_back(block.vertices[i]);
        mesh.normals.push_back(block.normals[i]);
        mesh.quality.push_back(block.quality[i]);
        seen.push_back(entry.seen);
        soft.push_back(block.soft.empty() ? 0 : block.soft[i]);
      }
      to.push_back(at->second);
    }
    for (const auto& t : block.triangles) {
      mesh.triangles.push_back({to[t[0]], to[t[1]], to[t[2]]});
    }
  }
  if (std::ranges::count(soft, 1) > 0) mesh.soft = std::move(soft);
  const ComponentStats removed = remove_small_components(
      mesh, {config_.min_component_triangles, config_.passing_triangles, config_.passing_bursts}, seen);
  if (stats != nullptr) {
    *stats = ExtractStats{removed.components, removed.removed, removed.triangles_removed};
  }
  return mesh;
}

}  // namespace enamel::pipeline
