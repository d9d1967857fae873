#include "pipeline/model/fuse/tissue_votes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace enamel::pipeline {
namespace {

constexpr std::uint16_t kFull = std::numeric_limits<std::uint16_t>::max();

void count(std::uint16_t& n) { n = static_cast<std::uint16_t>(n + (n < kFull ? 1 : 0)); }

struct Seen {
  int i = 0, j = 0;  ///< surfel
  Vec3f p = Vec3f::Zero();
  bool measured = false;
};

/// Where the burst saw a voxel of the block, camera frame.
Seen seen_at(const SurfelMap& surfels, const BlockInCamera& at, const Vec3f& voxel) {
  Seen out;
  out.p = at.origin + voxel.x() * at.step_x + voxel.y() * at.step_y + voxel.z() * at.step_z;
  if (!(out.p.z() > 1.0F)) return out;
  const float u = at.projection.u0 + (at.projection.uX * out.p.x() + at.projection.uY * out.p.y()) / out.p.z();
  const float v = at.projection.v0 + (at.projection.vX * out.p.x() + at.projection.vY * out.p.y()) / out.p.z();
  const auto width = static_cast<float>(surfels.width()), height = static_cast<float>(surfels.height());
  if (!(u >= 0.0F && v >= 0.0F && u < width - 1.0F && v < height - 1.0F)) return out;
  out.i = static_cast<int>(std::lround(u)), out.j = static_cast<int>(std::lround(v));
  out.measured = surfels(out.i, out.j).weight > 0.0F;
  return out;
}

/// Difference between burst and block at the block's surface, mean over its voxels there.
struct Difference {
  float sum_mm = 0, variance_mm2 = 0;
  int voxels = 0;
  [[nodiscard]] bool tells() const { return voxels >= kFewest; }
  [[nodiscard]] bool beyond_noise() const {
    const auto n = static_cast<float>(voxels);
    const float mean = sum_mm / n;
    return mean * mean > kSigmas * kSigmas * (variance_mm2 / n + kPoseSigma_mm * kPoseSigma_mm);
  }
  static constexpr int kFewest = 4;       ///< chosen: as of a block that is looked through
  static constexpr float kSigmas = 3.0F;  ///< chosen
};

Difference difference_to(const SurfelMap& surfels, const SurfacePatch& patch, const BlockInCamera& at, float near_mm,
                         const Block& block) {
  constexpr int kStep = 2;  // voxels: sixty-four of them tell
  Difference out;
  for (int z = 0; z < kBlockEdge; z += kStep) {
    for (int y = 0; y < kBlockEdge; y += kStep) {
      for (int x = 0; x < kBlockEdge; x += kStep) {
        const std::size_t k = voxel_index(x, y, z);
        if (!(block.weight[k] > 0.0F) || std::abs(block.distance_mm[k]) > near_mm) continue;
        const Seen seen = seen_at(surfels, at, {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
        if (!seen.measured) continue;
        const Surfel& s = surfels(seen.i, seen.j);
        const float measured = s.nx * seen.p.x() + s.ny * seen.p.y() + s.nz * seen.p.z() - s.offset_mm;
        const float sigma = patch.sigma_mm(seen.i * surfels.stride(), seen.j * surfels.stride());
        if (!std::isfinite(sigma)) continue;
        out.sum_mm += measured - block.distance_mm[k];
        out.variance_mm2 += sigma * sigma;  // of pixels close together: what light inside leaves is common to them
        ++out.voxels;
      }
    }
  }
  return out;
}

}  // namespace

void note_tissue(const SurfelMap& surfels, const SurfacePatch& patch, const BlockInCamera& at, double voxel_mm,
                 Block& block) {
  if (patch.shade.empty()) return;
  constexpr float kMiddle = 0.5F * (kBlockEdge - 1);
  const Seen middle = seen_at(surfels, at, Vec3f::Constant(kMiddle));
  const int stride = surfels.stride();
  const std::uint8_t shade = middle.measured ? shade_at(patch.shade, middle.i * stride, middle.j * stride) : kNoShade;
  BlockTissue& tissue = block.tissue;
  if (shade != kNoShade && tissue.shaded < kFull) tissue.shade_sum += shade, ++tissue.shaded;
  const Difference difference = difference_to(surfels, patch, at, static_cast<float>(voxel_mm), block);
  if (!difference.tells()) return;
  count(tissue.asked);
  if (difference.beyond_noise()) count(tissue.moved);
}

void note_looked_through(Block& block) {
  if (block.tissue.shaded == 0) return;
  count(block.tissue.asked);
  count(block.tissue.moved);
}

bool keeps_moving(const BlockTissue& tissue) noexcept {
  constexpr int kFewest = 4;  // chosen: two of two may be one bad pose
  return tissue.shaded > 0 && tissue.asked >= kFewest && 2 * tissue.moved > tissue.asked;
}

bool is_soft_at(const BlockGrid& grid, const Block& block, const Vec3f& voxel, std::uint8_t soft_below) noexcept {
  if (soft_below == kNothingSoft) return false;
  if (keeps_moving(block.tissue)) return true;
  const Vec3f from_middle = (voxel - Vec3f::Constant(0.5F * (kBlockEdge - 1))) / static_cast<float>(kBlockEdge);
  float sum = 0, weight = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    std::array<int, 3> step{};
    float w = 1;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const float d = from_middle[static_cast<int>(axis)], share = std::min(std::abs(d), 1.0F);
      const bool over = ((corner >> axis) & 1U) != 0;
      step[axis] = over ? (d < 0 ? -1 : 1) : 0;
      w *= over ? share : 1 - share;
    }
    const std::int32_t id = block.neighbour[neighbour_index(step[0], step[1], step[2])];
    if (id == kNoBlock || !(w > 0)) continue;
    const BlockTissue& tissue = grid.block(id).tissue;
    if (tissue.shaded == 0) continue;
    sum += w * static_cast<float>(tissue.shade_sum) / static_cast<float>(tissue.shaded);
    weight += w;
  }
  return weight > 0 && sum < weight * static_cast<float>(soft_below);
}

}  // namespace enamel::pipeline
