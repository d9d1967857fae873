#include "viewer/scene/mesh_diff.hpp"

#include <algorithm>
#include <limits>

namespace enamel::view {

std::size_t gpu_bytes(const BlockMesh& block) noexcept {
  return block.vertices.size() * kGpuVertexBytes + block.triangles.size() * kGpuTriangleBytes;
}

bool well_formed(const BlockMesh& block) noexcept {
  const std::size_t n = block.vertices.size();
  const bool sizes = (block.normals.empty() || block.normals.size() == n) &&
                     (block.quality.empty() || block.quality.size() == n) &&
                     (block.soft.empty() || block.soft.size() == n) && n < std::numeric_limits<std::uint32_t>::max();
  return sizes && std::all_of(block.triangles.begin(), block.triangles.end(),
                              [n](const auto& t) { return t[0] < n && t[1] < n && t[2] < n; });
}

std::vector<BlockIndex> MeshDiff::drop_vanished(const ModelSnapshot& model) {
  std::vector<BlockIndex> present;
  present.reserve(model.blocks.size());
  for (const auto& block : model.blocks) {
    if (block) {
      present.push_back(block->block);
    }
  }
  std::sort(present.begin(), present.end());
  std::vector<BlockIndex> vanished;
  for (auto it = sent_.begin(); it != sent_.end();) {
    if (std::binary_search(present.begin(), present.end(), it->first)) {
      ++it;
    } else {
      vanished.push_back(it->first);
      it = sent_.erase(it);
    }
  }
  return vanished;
}

UploadPlan MeshDiff::plan(const ModelSnapshot& model, std::size_t budget_bytes) {
  UploadPlan out;
  out.remove = drop_vanished(model);
  std::vector<const std::shared_ptr<const BlockMesh>*> changed;
  for (const auto& block : model.blocks) {
    if (block) {
      const auto known = sent_.find(block->block);
      if ((known == sent_.end() || known->second != block) && well_formed(*block)) {
        changed.push_back(&block);
      }
    }
  }
  const auto turn = std::partition_point(changed.begin(), changed.end(),
                                         [this](const auto* block) { return (*block)->block < next_; });
  std::rotate(changed.begin(), turn, changed.end());
  std::size_t bytes = 0;
  std::size_t taken = 0;
  for (; taken < changed.size(); ++taken) {
    const auto& block = *changed[taken];
    bytes += gpu_bytes(*block);
    if (taken > 0 && bytes > budget_bytes) {  // no small block overtakes: the order is the turn
      next_ = block->block;
      break;
    }
    sent_[block->block] = block;
    out.upload.push_back(block);
  }
  out.pending = changed.size() - taken;
  return out;
}

}  // namespace enamel::view
