// The model, and what was scanned apart from it: each segment is fused for itself until it is known where it lies, then
// its bursts are fused into the segment that it joined, a few with every burst that follows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/model/fuse/tsdf_model.hpp"
#include "pipeline/model/segments/packed_patch.hpp"
#include "pipeline/model/segments/patch_store.hpp"
#include "pipeline/types/track.hpp"

namespace enamel::pipeline {

struct KeptBurst {
  BurstId id;
  Pose T_segment_cam = Pose::Identity();
  StoredPatch patch;                              ///< SegmentedModel::patch_of()
  std::shared_ptr<const TexturePicture> texture;  ///< as TrackResult::texture
};

/// Results depend on the sequence of calls alone. Not thread-safe; one owner.
class SegmentedModel {
 public:
  /// keep_history: the model's bursts are kept too, for take_history().
  SegmentedModel(const calib::Rig& rig, const FuseConfig& config, Unpacker unpack, bool keep_history,
                 PatchStoreConfig store = {});

  /// Carries out the joins of the burst, then fuses it where it was placed. Precondition: it was placed.
  FuseStats integrate(BurstId burst, const SurfacePatch& patch, const TrackResult& placed);
  /// The segment that the last burst was fused into, as TsdfModel::view; a model that has still to take over bursts
  /// shows what it has.
  [[nodiscard]] ModelView view(const Pose& T_segment_cam, const SurfacePatch& hint);

  /// As TsdfModel's, of the model and all that is apart.
  void set_soft_below(std::uint8_t soft_below);
  [[nodiscard]] std::uint8_t soft_below() const noexcept { return config_.soft_below; }

  void join(const SegmentJoin& join);
  /// Fuses at most so many bursts of joined segments into the model.
  void catch_up(std::size_t bursts);

  /// Bursts in the model, those that wait included, in order of burst; empty where the history is not kept.
  [[nodiscard]] std::vector<KeptBurst> take_history();
  /// Fuses the model anew, from its history with other poses. `load`: the patch of a burst, by its index.
  void rebuild(const std::vector<KeptBurst>& history, const std::function<SurfacePatch(std::size_t)>& load);

  [[nodiscard]] TsdfModel& model() noexcept { return model_; }
  /// What the last burst was fused into, where that is not the model.
  [[nodiscard]] TsdfModel* apart() noexcept { return apart_ ? &apart_->model : nullptr; }
  /// How many times such a one was begun, or begun anew: with another count, it is another object.
  [[nodiscard]] std::uint64_t openings() const noexcept { return openings_; }
  [[nodiscard]] SegmentId active() const noexcept { return active_; }
  /// Bursts of the segments that are still apart, each segment's in order of burst.
  [[nodiscard]] const std::map<SegmentId, std::vector<KeptBurst>>& kept() const noexcept { return kept_; }
  /// A segment that is apart, fused anew from its bursts.
  [[nodiscard]] TsdfModel fuse_apart(SegmentId segment) const;
  /// What a burst was fused as, or nearly; its texture too, where it was apart and that is wanted. From any thread,
  /// also while other bursts are taken in.
  [[nodiscard]] SurfacePatch patch_of(const StoredPatch& patch, Texture texture) const {
    return unpack_(store_.load(patch, texture));
  }
  [[nodiscard]] SurfacePatch patch_of(const KeptBurst& burst, Texture texture) const {
    return patch_of(burst.patch, texture);
  }
  /// The patch of the last burst as it is kept; empty where the history is not.
  [[nodiscard]] const StoredPatch& last_kept() const noexcept { return last_kept_; }
  [[nodiscard]] PatchStore::Figures stored() const noexcept { return store_.figures(); }

 private:
  struct Apart {
    SegmentId id;
    TsdfModel model;
  };
  void open(SegmentId segment);

  calib::Rig rig_;
  FuseConfig config_;
  Unpacker unpack_;
  bool keep_history_;
  PatchStore store_;
  TsdfModel model_;
  std::optional<Apart> apart_;  ///< the last segment that a burst was placed in apart from the model
  SegmentId active_ = kModelSegment;
  std::uint64_t openings_ = 0;
  std::map<SegmentId, std::vector<KeptBurst>> kept_;
  std::vector<KeptBurst> history_;  ///< of the model
  std::deque<KeptBurst> waiting_;   ///< placed in the model, to be fused into it
  StoredPatch last_kept_;
};

}  // namespace enamel::pipeline
