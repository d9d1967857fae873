// Places each burst: in the segment where the hand is, else in one that it left a moment ago, else in a new segment of
// its own, which is joined to an older one as soon as bursts agree where it lies.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/register/icp/patch_view.hpp"
#include "pipeline/register/track/near_alignment.hpp"
#include "pipeline/register/track/segment_memory.hpp"
#include "pipeline/register/track/tracker_config.hpp"
#include "pipeline/types/model_view.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/probe_motion.hpp"
#include "pipeline/types/track.hpp"
#include "protocol/base/ids.hpp"
#include "protocol/base/time.hpp"

namespace enamel::pipeline {

/// A burst that stands in a segment, to be found in another.
struct PlacedBurst {
  BurstId id;
  SegmentId segment = kModelSegment;
  Pose T_segment_cam = Pose::Identity();
};

/// One burst after the other, in order of burst; single-threaded. Results are a function of the sequence of arguments
/// only. A patch whose result is kLost must not be fused. The model's frame is that of the first patch placed and never
/// changes.
class Tracker {
 public:
  Tracker(const calib::Rig& rig, const TrackerConfig& config);
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  /// view: a segment as it was some bursts ago, drawn from any recent pose, or empty. t_mid: data time of mid-burst.
  /// twist: what the burst itself shows of the probe's velocity; a prior for the bursts to come.
  /// The patch is kept until the next one is placed.
  [[nodiscard]] TrackResult track(BurstId burst, DeviceTime t_mid, const std::shared_ptr<const SurfacePatch>& patch,
                                  const ModelView& view, const std::optional<ProbeTwist>& twist = std::nullopt);
  /// The same of a patch that nobody shares.
  [[nodiscard]] TrackResult track(BurstId burst, DeviceTime t_mid, SurfacePatch patch, const ModelView& view,
                                  const std::optional<ProbeTwist>& twist = std::nullopt) {
    return track(burst, t_mid, std::make_shared<const SurfacePatch>(std::move(patch)), view, twist);
  }

  /// Shades below it are soft tissue's and weigh little, in the bursts to come.
  void set_soft_below(std::uint8_t soft_below) noexcept { config_.icp.samples.soft_below = soft_below; }

  /// Looks for the place of a burst, whose segment is still apart, in the older segments that are remembered. After the
  /// scan, when these have all their keyframes; `burst` as track() placed it, after the joins since.
  [[nodiscard]] std::optional<SegmentJoin> seek(const PlacedBurst& burst, const SurfacePatch& patch);

  /// After the scan, when nothing is sought any more: frees what was remembered, a third of a gigabyte for an arch.
  void forget() { segments_.clear(); }

  /// The model first; segments that were joined are gone. Empty before the first burst.
  [[nodiscard]] const std::vector<SegmentMemory>& segments() const noexcept { return segments_; }
  [[nodiscard]] const TrackerConfig& config() const noexcept { return config_; }

 private:
  struct Burst;
  [[nodiscard]] bool was_here(const SegmentMemory& segment, const Burst& burst) const;
  /// In one that the hand left a moment ago. Where the burst stands in the active one too, that is a vote.
  [[nodiscard]] std::optional<TrackResult> back_in_an_older(const Burst& burst, const std::optional<IcpResult>& here);
  /// A new segment. What is remembered of others is cut to what can still be of use.
  [[nodiscard]] SegmentMemory& start(const Burst& burst);
  /// The oldest of the smallest segments first, until the others leave room.
  void forget_the_smallest();
  void remember_texture(SegmentMemory& segment, const Burst& burst, const IcpResult& icp) const;
  [[nodiscard]] TrackResult accept(SegmentMemory& segment, TrackState state, const Burst& burst, const IcpResult& icp);
  [[nodiscard]] std::optional<SegmentJoin> vote(const PlacedBurst& placed, const SurfacePatch& patch,
                                                const PatchPyramid& pyramid);
  /// Counts a vote, and carries out the join that it decides.
  [[nodiscard]] std::optional<SegmentJoin> believe(const PlacedBurst& placed, SegmentId into, const Pose& T_into_cam);
  void carry_out(const SegmentJoin& join);
  [[nodiscard]] SegmentMemory& find(SegmentId id);

  TrackerConfig config_;
  calib::LensValues lens_;
  BurstTexture::Config texture_;
  std::size_t grid_size_ = 0;  ///< samples of a full image at the finest level
  PatchViewer viewer_;
  NearAlignment near_;
  std::vector<SegmentMemory> segments_;  ///< ascending id
  SegmentId active_ = kModelSegment;     ///< where the last burst was placed
  SegmentId next_id_ = kModelSegment;
  JoinVotes votes_;
  PatchPyramid pyramid_;                 ///< of the burst at hand
  std::optional<DeviceTime> last_seen_;  ///< of the last burst handed in
  std::uint64_t searches_ = 0;
};

}  // namespace enamel::pipeline
