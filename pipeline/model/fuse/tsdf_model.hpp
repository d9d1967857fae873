// The growing model: sparse truncated signed distance field (Curless & Levoy 1996, block hash as Niessner et al. 2013).
// Distances in mm, positive outside (towards the camera). Results depend on the sequence of integrate() calls alone:
// blocks are allocated in raster order, the hash is never iterated. Not thread-safe; one owner.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/model/fuse/block_grid.hpp"
#include "pipeline/model/fuse/depth_hint.hpp"
#include "pipeline/model/fuse/fuse_config.hpp"
#include "pipeline/model/fuse/surfel_map.hpp"
#include "pipeline/model/fuse/view_planes.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/model_view.hpp"
#include "pipeline/types/patch.hpp"
#include "protocol/base/ids.hpp"

namespace enamel::pipeline {

class TsdfModel {
 public:
  /// Keeps the camera's lens values of the rig; the patches must have the camera's size.
  explicit TsdfModel(const calib::Rig& rig, const FuseConfig& config = {});

  /// Fuses one placed patch. A patch of another size or without points changes nothing (all counts 0).
  FuseStats integrate(BurstId burst, const SurfacePatch& patch, const Pose& T_model_cam);

  /// The model as seen from T_model_cam, searched near the depth of `hint` (a patch taken from about that pose: the one
  /// just fused) and, where that has holes, near the depth of its surroundings. Shows every observed voxel, also those
  /// seen once.
  [[nodiscard]] ModelView view(const Pose& T_model_cam, const SurfacePatch& hint);

  /// Blocks whose voxels began or ceased to count as surface, or whose surface moved by at least min_move_mm, since
  /// they were last taken; ordered by index. Taking marks them as unchanged.
  [[nodiscard]] std::vector<BlockIndex> take_changed(double min_move_mm = 0.0);

  /// True if a voxel counts as surface in the mesh.
  [[nodiscard]] bool is_surface(const Block& block, std::size_t voxel) const noexcept {
    return block.observations[voxel] >= config_.min_observations && block.bursts[voxel] >= config_.min_bursts;
  }

  /// Shades below it are soft tissue's: what is meshed from now on is told so. kNothingSoft: nothing is.
  void set_soft_below(std::uint8_t soft_below) noexcept { config_.soft_below = soft_below; }

  [[nodiscard]] const BlockGrid& grid() const noexcept { return grid_; }
  [[nodiscard]] const FuseConfig& config() const noexcept { return config_; }
  [[nodiscard]] bool empty() const noexcept { return integrations_ == 0; }
  [[nodiscard]] std::uint64_t after_burst() const noexcept { return after_burst_; }

 private:
  void allocate_band(const SurfacePatch& patch, const Pose& T_model_cam, FuseStats& stats);
  /// slot: of the points along a normal, of which each goes its own way through the blocks.
  void touch(const Vec3f& p_model, std::size_t slot, FuseStats& stats);
  void carve(const SurfacePatch& patch, const Pose& T_cam_model, FuseStats& stats);
  void note_changed(std::int32_t id);
  void carve_confirmed(const SurfacePatch& patch, const Pose& T_cam_model, FuseStats& stats);

  FuseConfig config_;
  calib::LensValues camera_;
  int view_stride_;  ///< camera pixels a pixel of ModelView
  BlockGrid grid_;
  SurfelMap surfels_;
  std::vector<std::int32_t> touched_;    ///< ids of the blocks in the band of the current patch, in raster order
  std::vector<std::int32_t> tentative_;  ///< ids of blocks without confirmed voxels, in order of allocation
  std::vector<std::int32_t> pending_;    ///< ids of blocks changed since they were last taken, in order of change
  std::array<BlockIndex, 3> last_{};     ///< found by the last touch() of each slot
  CoarseDepth coarse_;                   ///< of the view being drawn, as
  ViewPlanes planes_;                    ///< these
  std::uint64_t integrations_ = 0;
  std::uint64_t after_burst_ = 0;
};

}  // namespace enamel::pipeline
