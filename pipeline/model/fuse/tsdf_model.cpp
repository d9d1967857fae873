#include "pipeline/model/fuse/tsdf_model.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/model/fuse/integrate_block.hpp"
#include "pipeline/model/fuse/projection.hpp"
#include "pipeline/model/fuse/see_through.hpp"
#include "pipeline/model/fuse/tissue_votes.hpp"
#include "pipeline/types/pixel_step.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kBandStride = 4;  ///< pixels between the samples that allocate: 0.11 mm on the object, blocks are 0.8 mm

bool usable(const SurfacePatch& patch, const calib::LensValues& camera) {
  const auto fits = [&](const auto& map) { return map.width() == camera.width && map.height() == camera.height; };
  return camera.width > 1 && camera.height > 1 && fits(patch.depth_mm) && fits(patch.sigma_mm) && fits(patch.points) &&
         fits(patch.normals);
}

BlockInCamera place(const Block& block, double voxel_mm, const Pose& T_cam_model, const calib::LensValues& camera,
                    int stride) {
  const Vec3d first = Vec3d(block.index[0], block.index[1], block.index[2]) * (kBlockEdge * voxel_mm);
  const Vec3d middle = first + Vec3d::Constant(0.5 * (kBlockEdge - 1) * voxel_mm);
  const Eigen::Matrix3d step = T_cam_model.linear() * voxel_mm;
  BlockInCamera at;
  at.origin = (T_cam_model * first).cast<float>();
  at.step_x = step.col(0).cast<float>();
  at.step_y = step.col(1).cast<float>();
  at.step_z = step.col(2).cast<float>();
  at.projection = local_projection(camera, T_cam_model * middle, stride);
  return at;
}

void clear(Block& block) {
  block.distance_mm.fill(0.0F);
  block.weight.fill(0.0F);
  block.observations.fill(0);
  block.bursts.fill(0);
  block.touched_by = 0;
  block.first_burst = ~std::uint64_t{0};
  block.last_burst = 0;
  block.moments = block.against = 0;
  block.tissue = {};
}

}  // namespace

TsdfModel::TsdfModel(const calib::Rig& rig, const FuseConfig& config)
    : config_(config),
      camera_(rig.camera),
      view_stride_(pixel_step(config.view_pitch_mm, rig.camera.fx / calib::middle_depth_mm(rig))),
      surfels_(rig, config) {}

void TsdfModel::touch(const Vec3f& p_model, std::size_t slot, FuseStats& stats) {
  const auto per_block = static_cast<float>(1.0 / (config_.voxel_mm * kBlockEdge));
  BlockIndex index{};
  for (int k = 0; k < 3; ++k) {
    const float at = p_model[k] * per_block;
    if (!(std::fabs(at) < static_cast<float>(kBlockRange - 2))) {
      return;  // beyond what the index can name: hundreds of metres from the origin
    }
    const auto whole = static_cast<std::int32_t>(at);
    index[static_cast<std::size_t>(k)] = whole - static_cast<std::int32_t>(at < static_cast<float>(whole));  // floor
  }
  if (index == last_[0] || index == last_[1] || index == last_[2]) {
    return;
  }
  last_[slot] = index;
  const std::size_t before = grid_.size();
  const std::int32_t id = grid_.allocate(index);
  Block& block = grid_.block(id);
  if (grid_.size() != before) {
    ++stats.blocks_new;
    tentative_.push_back(id);
  }
  if (block.touched_by != integrations_) {
    block.touched_by = integrations_;
    touched_.push_back(id);
  }
}

void TsdfModel::allocate_band(const SurfacePatch& patch, const Pose& T_model_cam, FuseStats& stats) {
  const Eigen::Matrix3f R = T_model_cam.linear().cast<float>();
  const Vec3f t = T_model_cam.translation().cast<float>();
  const auto reach = static_cast<float>(config_.voxel_mm * config_.truncation_voxels);
  touched_.clear();
  last_.fill({kBlockRange, kBlockRange, kBlockRange});  // none
  const int step = kBandStride / surfels_.stride();
  for (int j = 0; j < surfels_.height(); j += step) {
    for (int i = 0; i < surfels_.width(); i += step) {
      if (!(surfels_(i, j).weight > 0.0F)) {
        continue;
      }
      const std::size_t pixel = patch.points.index(i * surfels_.stride(), j * surfels_.stride());
      const Vec3f p = R * patch.points[pixel] + t;
      const Vec3f along = R * patch.normals[pixel] * reach;
      touch(p - along, 0, stats);
      touch(p, 1, stats);
      touch(p + along, 2, stats);
    }
  }
  stats.blocks_touched = static_cast<std::uint32_t>(touched_.size());
}

FuseStats TsdfModel::integrate(BurstId burst, const SurfacePatch& patch, const Pose& T_model_cam) {
  FuseStats stats;
  if (!usable(patch, camera_) || !T_model_cam.matrix().allFinite()) {
    return stats;
  }
  surfels_.build(patch, config_, stats);
  if (stats.surfels_used == 0) {
    return stats;
  }
  ++integrations_;
  after_burst_ = std::max(after_burst_, burst.value);
  allocate_band(patch, T_model_cam, stats);
  const Pose T_cam_model = T_model_cam.inverse();
  for (const std::int32_t id : touched_) {
    Block& block = grid_.block(id);
    const BlockInCamera at = place(block, config_.voxel_mm, T_cam_model, camera_, surfels_.stride());
    note_tissue(surfels_, patch, at, config_.voxel_mm, block);
    const std::uint64_t updated = integrate_block(surfels_, at, config_, block);
    stats.voxels_updated += updated;
    if (updated > 0) {
      note_measured(block, burst.value);
    }
    if (block.grown || block.moved_mm > 0.0F) {
      note_changed(id);
    }
  }
  carve(patch, T_cam_model, stats);
  if (config_.carve_bursts > 0) {
    carve_confirmed(patch, T_cam_model, stats);
  }
  return stats;
}

void TsdfModel::note_changed(std::int32_t id) {
  Block& block = grid_.block(id);
  if (block.pending) {
    return;
  }
  block.pending = true;
  pending_.push_back(id);
}

// Free space: a block that no second burst has confirmed and that this burst looks through, with a margin, to a surface
// behind it was an outlier. Looked at in its middle only: cheap, and enough for what is not in the mesh anyway.
void TsdfModel::carve(const SurfacePatch& patch, const Pose& T_cam_model, FuseStats& stats) {
  const double half = 0.5 * (kBlockEdge - 1) * config_.voxel_mm;
  const double margin = config_.carve_margin_mm + 2.0 * half;
  const auto confirmed = [&](std::int32_t id) { return grid_.block(id).confirmed; };
  tentative_.erase(std::remove_if(tentative_.begin(), tentative_.end(), confirmed), tentative_.end());
  for (const std::int32_t id : tentative_) {
    Block& block = grid_.block(id);
    if (block.touched_by == integrations_ || block.touched_by == 0) {
      continue;
    }
    const Vec3d middle = Vec3d(block.index[0], block.index[1], block.index[2]) * (kBlockEdge * config_.voxel_mm);
    const Vec3d p = T_cam_model * (middle + Vec3d::Constant(half));
    if (p.z() < 1.0) {
      continue;
    }
    const LocalProjection local = local_projection(camera_, p, surfels_.stride());
    const double u = local.u0 + (local.uX * p.x() + local.uY * p.y()) / p.z();
    const double v = local.v0 + (local.vX * p.x() + local.vY * p.y()) / p.z();
    if (!(u >= 0.0 && v >= 0.0 && u < surfels_.width() - 1.0 && v < surfels_.height() - 1.0)) {
      continue;
    }
    const int i = static_cast<int>(std::lround(u));
    const int j = static_cast<int>(std::lround(v));
    if (surfels_(i, j).weight > 0.0F && patch.depth_mm(i * surfels_.stride(), j * surfels_.stride()) > p.z() + margin) {
      clear(block);
      ++stats.blocks_carved;
    }
  }
}

// A tongue at rest is confirmed by the second burst that sees it. What looks through it later has its say as well.
void TsdfModel::carve_confirmed(const SurfacePatch& patch, const Pose& T_cam_model, FuseStats& stats) {
  const double edge = kBlockEdge * config_.voxel_mm, half = 0.5 * (kBlockEdge - 1) * config_.voxel_mm;
  const Eigen::Matrix3f R = (T_cam_model.linear() * edge).cast<float>();
  const Vec3f t = (T_cam_model * Vec3d::Constant(half)).cast<float>();
  const auto margin = static_cast<float>(config_.carve_confirmed_mm);
  const auto fx = static_cast<float>(camera_.fx), fy = static_cast<float>(camera_.fy);
  const auto cx = static_cast<float>(camera_.cx) + 0.5F, cy = static_cast<float>(camera_.cy) + 0.5F;
  const auto blocks = static_cast<std::int32_t>(grid_.size());
  for (std::int32_t id = 0; id < blocks; ++id) {
    const BlockIndex& index = grid_.index_of(id);
    const Vec3f p =
        R * Vec3f(static_cast<float>(index[0]), static_cast<float>(index[1]), static_cast<float>(index[2])) + t;
    if (!(p.z() > 1.0F)) {
      continue;
    }
    // The lens bends by a few pixels, a block is thirty wide: good enough to choose whom to ask.
    const float u = fx * p.x() / p.z() + cx, v = fy * p.y() / p.z() + cy;
    const auto width = static_cast<float>(camera_.width), height = static_cast<float>(camera_.height);
    if (!(u >= 0.0F && v >= 0.0F && u < width && v < height) ||
        !(patch.depth_mm(static_cast<int>(u), static_cast<int>(v)) > p.z() + margin)) {
      continue;
    }
    Block& block = grid_.block(id);
    if (!block.confirmed || block.touched_by == integrations_) {
      continue;
    }
    const BlockInCamera at = place(block, config_.voxel_mm, T_cam_model, camera_, surfels_.stride());
    if (!looks_through(surfels_, patch, at, config_.carve_confirmed_mm, block)) {
      continue;
    }
    note_looked_through(block);
    block.against = static_cast<std::uint8_t>(std::min(255, block.against + 1));
    if (block.against < config_.carve_bursts * block.moments) {
      continue;
    }
    clear(block);
    block.confirmed = false;
    tentative_.push_back(id);
    block.grown = true;
    note_changed(id);
    ++stats.blocks_carved;
  }
}

std::vector<BlockIndex> TsdfModel::take_changed(double min_move_mm) {
  const auto limit = static_cast<float>(min_move_mm);
  std::vector<BlockIndex> changed;
  const auto take = [&](std::int32_t id) {
    Block& block = grid_.block(id);
    if (!block.grown && block.moved_mm < limit) {
      return false;
    }
    changed.push_back(block.index);
    block.grown = block.pending = false;
    block.moved_mm = 0.0F;
    return true;
  };
  pending_.erase(std::remove_if(pending_.begin(), pending_.end(), take), pending_.end());
  std::sort(changed.begin(), changed.end());
  return changed;
}

}  // namespace enamel::pipeline
