// The growing model as the viewer and the exporter take it. Immutable once published; blocks are shared between
// snapshots.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel {

/// Surface inside one TSDF block, model frame, mm. A block that changes is published anew with a higher epoch.
struct BlockMesh {
  std::array<std::int32_t, 3> block{};  ///< block index: floor(position / block edge)
  std::uint64_t epoch = 0;              ///< burst after which it was meshed, + 1
  std::vector<Vec3f> vertices;
  std::vector<Vec3f> normals;  ///< one a vertex, unit, outwards
  std::vector<float> quality;  ///< one a vertex, 0 (seen once, steep) … 1 (seen often, facing)
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint8_t> soft = {};  ///< empty (nothing is) or one a vertex: 1 on soft tissue
};

struct ModelSnapshot {
  std::uint64_t after_burst = 0;
  std::vector<std::shared_ptr<const BlockMesh>> blocks;  ///< ordered by block index (x, y, z)
};

}  // namespace enamel
