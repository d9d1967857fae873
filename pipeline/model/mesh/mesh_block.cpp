#include "pipeline/model/mesh/mesh_block.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "pipeline/model/fuse/tissue_votes.hpp"
#include "pipeline/model/mesh/cell_table.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
/// Vertices keep this share of an edge away from its ends: a voxel exactly on the surface makes no triangle without
/// area.
constexpr float kEndMargin = 1e-3F;

// Block that holds voxel (x, y, z), each -8 … 15, counted from `block`'s first.
std::int32_t owner(const Block& block, int x, int y, int z) noexcept {
  return block.neighbour[neighbour_index(x >> 3, y >> 3, z >> 3)];
}

/// The same for all blocks that share the edge: it is asked of the block that holds its lower end.
bool is_soft_on_edge(const TsdfModel& model, const Block& block, const std::array<int, 3>& lower, int axis, float t) {
  const std::uint8_t soft_below = model.config().soft_below;
  if (soft_below == kNothingSoft) return false;
  const std::int32_t id = owner(block, lower[0], lower[1], lower[2]);
  Vec3f voxel(static_cast<float>(lower[0] & 7), static_cast<float>(lower[1] & 7), static_cast<float>(lower[2] & 7));
  voxel[axis] += t;
  return is_soft_at(model.grid(), model.grid().block(id), voxel, soft_below);
}

}  // namespace

void BlockMesher::classify(const TsdfModel& model, const Block& block) {
  for (int z = 0; z < kCorners; ++z) {
    for (int y = 0; y < kCorners; ++y) {
      unsigned inside = 0;
      unsigned usable = 0;
      const auto look = [&](int from, int to) {
        const std::int32_t id = owner(block, from, y, z);
        if (id == kNoBlock) {
          return;
        }
        const Block& b = model.grid().block(id);
        for (int x = from; x < to; ++x) {
          const std::size_t i = voxel_index(x & 7, y & 7, z & 7);
          inside |= (b.distance_mm[i] < 0.0F ? 1U : 0U) << static_cast<unsigned>(x);
          usable |= (model.is_surface(b, i) ? 1U : 0U) << static_cast<unsigned>(x);
        }
      };
      look(0, kBlockEdge);
      look(kBlockEdge, kCorners);
      inside_[row(y, z)] = static_cast<std::uint16_t>(inside);
      usable_[row(y, z)] = static_cast<std::uint16_t>(usable);
    }
  }
}

// Cells with corners on both sides and all corners usable, 8 at a time.
bool BlockMesher::find_cells() {
  unsigned any_active = 0;
  for (int z = 0; z < kBlockEdge; ++z) {
    for (int y = 0; y < kBlockEdge; ++y) {
      unsigned any = 0;
      unsigned all = ~0U;
      unsigned usable = ~0U;
      for (const std::size_t r : {row(y, z), row(y + 1, z), row(y, z + 1), row(y + 1, z + 1)}) {
        any |= inside_[r];
        all &= inside_[r];
        usable &= usable_[r];
      }
      any |= any >> 1U;
      all &= all >> 1U;
      usable &= usable >> 1U;
      const unsigned active = any & ~all & usable & 0xFFU;
      active_[voxel_index(y, z, 0)] = static_cast<std::uint16_t>(active);
      any_active |= active;
    }
  }
  return any_active != 0;
}

void BlockMesher::gather(const TsdfModel& model, const Block& block) {
  for (int z = -1; z < kPadded - 1; ++z) {
    for (int y = -1; y < kPadded - 1; ++y) {
      const auto copy = [&](int from, int to) {
        const std::int32_t id = owner(block, from, y, z);
        const Block* b = id == kNoBlock ? nullptr : &model.grid().block(id);
        for (int x = from; x < to; ++x) {
          const std::size_t i = voxel_index(x & 7, y & 7, z & 7);
          distance_[padded(x, y, z)] = b != nullptr && b->weight[i] > 0.0F ? b->distance_mm[i] : kNan;
        }
      };
      copy(-1, 0);
      copy(0, kBlockEdge);
      copy(kBlockEdge, kPadded - 1);
    }
  }
}

// Central differences, one-sided at the rim of what was observed.
Vec3f BlockMesher::gradient(const std::array<int, 3>& at) const {
  constexpr std::array<std::ptrdiff_t, 3> kStep{1, kPadded, kPadded * kPadded};
  const auto middle = static_cast<std::ptrdiff_t>(padded(at[0], at[1], at[2]));
  const float here = distance_[static_cast<std::size_t>(middle)];
  Vec3f g;
  for (std::size_t k = 0; k < 3; ++k) {
    const float before = distance_[static_cast<std::size_t>(middle - kStep[k])];
    const float after = distance_[static_cast<std::size_t>(middle + kStep[k])];
    const float up = std::isnan(after) ? 0.0F : after - here;
    const float down = std::isnan(before) ? 0.0F : here - before;
    g[static_cast<int>(k)] = std::isnan(after) || std::isnan(before) ? up + down : 0.5F * (up + down);
  }
  return g;
}

std::uint32_t BlockMesher::vertex(const TsdfModel& model, std::int32_t block_id, const std::array<int, 3>& lower,
                                  int axis, MeshedBlock& out) {
  const int at_edge = ((axis * kCorners + lower[2]) * kCorners + lower[1]) * kCorners + lower[0];
  const auto slot = static_cast<std::size_t>(at_edge);
  if (vertex_of_[slot] >= 0) {
    return static_cast<std::uint32_t>(vertex_of_[slot]);
  }
  std::array<int, 3> upper = lower;
  ++upper[static_cast<std::size_t>(axis)];
  const float a = distance_[padded(lower[0], lower[1], lower[2])];
  const float b = distance_[padded(upper[0], upper[1], upper[2])];
  const float t = std::clamp(a / (a - b), kEndMargin, 1.0F - kEndMargin);
  const Block& block = model.grid().block(block_id);
  Vec3d at;
  for (std::size_t k = 0; k < 3; ++k) {
    at[static_cast<int>(k)] = static_cast<double>(block.index[k]) * kBlockEdge + lower[k];
  }
  at[axis] += static_cast<double>(t);
  const Vec3f g = gradient(lower) * (1.0F - t) + gradient(upper) * t;
  const float length = std::sqrt((g.x() * g.x() + g.y() * g.y()) + g.z() * g.z());
  const auto weight_of = [&](const std::array<int, 3>& q) {
    if (((q[0] | q[1] | q[2]) & ~7) == 0) {
      return block.weight[voxel_index(q[0], q[1], q[2])];
    }
    return model.grid().block(owner(block, q[0], q[1], q[2])).weight[voxel_index(q[0] & 7, q[1] & 7, q[2] & 7)];
  };
  const float weight = weight_of(lower) * (1.0F - t) + weight_of(upper) * t;
  const auto index = static_cast<std::uint32_t>(out.mesh.vertices.size());
  out.mesh.vertices.emplace_back((at * model.config().voxel_mm).cast<float>());
  out.mesh.normals.emplace_back(g / length);
  out.mesh.quality.push_back(weight / (weight + static_cast<float>(config_.half_quality_weight)));
  out.mesh.soft.push_back(is_soft_on_edge(model, block, lower, axis, t) ? 1 : 0);
  out.edge_keys.push_back(edge_key(owner(block, lower[0], lower[1], lower[2]),
                                   voxel_index(lower[0] & 7, lower[1] & 7, lower[2] & 7),
                                   static_cast<std::size_t>(axis)));
  vertex_of_[slot] = static_cast<std::int32_t>(index);
  return index;
}

void BlockMesher::mesh_cell(const TsdfModel& model, std::int32_t block_id, int x, int y, int z, MeshedBlock& out) {
  unsigned inside = 0;
  float low = std::numeric_limits<float>::max();
  float high = -low;
  for (unsigned c = 0; c < 8; ++c) {
    const int corner = static_cast<int>(c);
    const float d = distance_[padded(x + (corner & 1), y + ((corner >> 1) & 1), z + (corner >> 2))];
    inside |= (d < 0.0F ? 1U : 0U) << c;
    low = std::min(low, d);
    high = std::max(high, d);
  }
  if (high - low > static_cast<float>(config_.max_step_voxels * model.config().voxel_mm)) {
    return;
  }
  for (const auto& triangle : cell_table()[inside]) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const int lower = kCellEdge[triangle[k]][0];
      corners[k] =
          vertex(model, block_id, {x + (lower & 1), y + ((lower >> 1) & 1), z + (lower >> 2)}, triangle[k] / 4, out);
    }
    out.mesh.triangles.push_back(corners);
  }
}

void BlockMesher::run(const TsdfModel& model, std::int32_t block_id, MeshedBlock& out) {
  const Block& block = model.grid().block(block_id);
  out.mesh.vertices.clear();
  out.mesh.normals.clear();
  out.mesh.quality.clear();
  out.mesh.triangles.clear();
  out.mesh.soft.clear();
  out.edge_keys.clear();
  out.mesh.block = block.index;
  out.mesh.epoch = model.after_burst() + 1;
  if (!block.confirmed) {
    return;  // every cell's lowest corner lies in this block and would have to count as surface
  }
  classify(model, block);
  if (!find_cells()) {
    return;
  }
  gather(model, block);
  vertex_of_.fill(-1);
  for (int z = 0; z < kBlockEdge; ++z) {
    for (int y = 0; y < kBlockEdge; ++y) {
      for (unsigned cells = active_[voxel_index(y, z, 0)]; cells != 0; cells &= cells - 1) {
        mesh_cell(model, block_id, std::countr_zero(cells), y, z, out);
      }
    }
  }
  if (std::ranges::count(out.mesh.soft, 0) == std::ssize(out.mesh.soft)) out.mesh.soft.clear();
}

}  // namespace enamel::pipeline
