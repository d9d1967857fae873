#include "pipeline/model/fuse/see_through.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::pipeline {

void note_measured(Block& block, std::uint64_t burst) {
  const bool first = block.first_burst > block.last_burst;
  if (first || burst > block.last_burst + kMomentBursts) {
    block.moments = static_cast<std::uint8_t>(std::min(255, block.moments + 1));
  }
  block.first_burst = std::min(block.first_burst, burst);
  block.last_burst = std::max(block.last_burst, burst);
  block.against = 0;
}

bool looks_through(const SurfelMap& surfels, const SurfacePatch& patch, const BlockInCamera& at, double margin_mm,
                   const Block& block) {
  constexpr int kStep = 2;            // voxels: sixty-four of them tell
  constexpr int kFewest = 4;          // inside, and met by a measurement
  constexpr double kShare = 0.8;      // of these, seen through
  constexpr float kInsideMm = -0.1F;  // behind the surface by more than a pixel may be off at its silhouette
  const auto margin = static_cast<float>(margin_mm);
  int inside = 0, through = 0;
  for (int z = 0; z < kBlockEdge; z += kStep) {
    for (int y = 0; y < kBlockEdge; y += kStep) {
      for (int x = 0; x < kBlockEdge; x += kStep) {
        const std::size_t voxel = voxel_index(x, y, z);
        if (!(block.weight[voxel] > 0.0F) || block.distance_mm[voxel] > kInsideMm) continue;
        const Vec3f p = at.origin + static_cast<float>(x) * at.step_x + static_cast<float>(y) * at.step_y +
                        static_cast<float>(z) * at.step_z;
        const float u = at.projection.u0 + (at.projection.uX * p.x() + at.projection.uY * p.y()) / p.z();
        const float v = at.projection.v0 + (at.projection.vX * p.x() + at.projection.vY * p.y()) / p.z();
        const int i = static_cast<int>(std::lround(u)), j = static_cast<int>(std::lround(v));
        if (i < 0 || j < 0 || i >= surfels.width() || j >= surfels.height() || !(surfels(i, j).weight > 0.0F)) continue;
        ++inside;
        through += patch.depth_mm(i * surfels.stride(), j * surfels.stride()) > p.z() + margin ? 1 : 0;
      }
    }
  }
  return inside >= kFewest && through >= kShare * inside;
}

}  // namespace enamel::pipeline
