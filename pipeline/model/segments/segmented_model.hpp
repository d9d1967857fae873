// The model, and what was scanned apart from it: each segment is fused for itself until it is known where it lies, then
// its bursts are fused into the segment that it joined, a few with every burst that follows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "pipeline/model/fuse/tsdf_model.hpp"
#include "pipeline/model/segments/packed_patch.hpp"
#include "pipeline/types/track.hpp"

namespace enamel::pipeline {

struct KeptBurst {
  BurstId id;
  Pose T_segment_cam = Pose::Identity();
  PackedPatch patch;
};

/// Results depend on the sequence of calls alone. Not thread-safe; one owner.
class SegmentedModel {
 public:
  SegmentedModel(const calib::Rig& rig, const FuseConfig& config, Unpacker unpack);

  /// Carries out the joins of the burst, then fuses it where it was placed. Precondition: it was placed.
  FuseStats integrate(BurstId burst, const SurfacePatch& patch, const TrackResult& placed);
  /// The segment that the last burst was fused into, as TsdfModel::view; a model that has still to take over bursts
  /// shows what it has.
  [[nodiscard]] ModelView view(const Pose& T_segment_cam, const SurfacePatch& hint) const;

  void join(const SegmentJoin& join);
  /// Fuses at most so many bursts of joined segments into the model.
  void catch_up(std::size_t bursts);

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
  [[nodiscard]] const Unpacker& unpack() const noexcept { return unpack_; }

 private:
  struct Apart {
    SegmentId id;
    TsdfModel model;
  };
  void open(SegmentId segment);

  calib::Rig rig_;
  FuseConfig config_;
  Unpacker unpack_;
  TsdfModel model_;
  std::optional<Apart> apart_;  ///< the last segment that a burst was placed in apart from the model
  SegmentId active_ = kModelSegment;
  std::uint64_t openings_ = 0;
  std::map<SegmentId, std::vector<KeptBurst>> kept_;
  std::deque<KeptBurst> waiting_;  ///< placed in the model, to be fused into it
};

}  // namespace enamel::pipeline
