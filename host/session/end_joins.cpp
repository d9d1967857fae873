#include "host/session/end_joins.hpp"

#include <algorithm>
#include <optional>

#include "pipeline/register/track/mid_burst.hpp"

namespace enamel::host {
namespace {

std::vector<SegmentId> apart_now(const pipeline::SegmentedModel& segments) {
  std::vector<SegmentId> out;
  for (const auto& [id, bursts] : segments.kept()) out.push_back(id);
  return out;
}

std::optional<SegmentJoin> seek(stage::TrackStage& track, const pipeline::SegmentedModel& segments, SegmentId id,
                                std::size_t at_most) {
  const std::vector<pipeline::KeptBurst>& bursts = segments.kept().at(id);
  const std::size_t asked = std::min(bursts.size(), at_most);
  for (std::size_t i = 0; i < asked; ++i) {
    const pipeline::KeptBurst& burst = bursts[i * bursts.size() / asked];
    const SurfacePatch patch = segments.patch_of(burst, pipeline::Texture::kKept);
    if (auto join = track.seek({burst.id, id, burst.T_segment_cam}, patch)) return join;
  }
  return std::nullopt;
}

}  // namespace

void join_at_end(stage::TrackStage& track, stage::FuseStage& fuse, SegmentLedger& ledger,
                 const pipeline::JoinConfig& config) {
  // The youngest last: what older ones were joined to shows more surface then.
  for (const SegmentId id : apart_now(fuse.segments())) {
    if (fuse.segments().kept().at(id).size() < config.votes) continue;  // cannot agree among themselves
    const auto join = seek(track, fuse.segments(), id, config.at_end);
    if (!join) continue;
    fuse.segments().join(*join);
    ledger.joined(*join, std::nullopt);
  }
}

std::vector<MeasuredBurst> bursts_in(SegmentId root, const SinkStage& sink) {
  std::vector<MeasuredBurst> out;
  for (std::size_t i = 0; i < sink.placed.size(); ++i) {
    const SegmentLedger::Root at = sink.segments.root_of(sink.placed[i].segment);
    if (at.id != root) continue;
    out.push_back({sink.placed[i].id, sink.poses[i], sink.placed[i].sight});
    out.back().pose.T_model_cam = at.T_root_segment * out.back().pose.T_model_cam;
  }
  return out;
}

std::vector<PlacedPose> at_mid_burst(const std::vector<MeasuredBurst>& bursts) {
  std::vector<pipeline::MeasuredPose> measured;
  measured.reserve(bursts.size());
  for (const MeasuredBurst& burst : bursts) measured.push_back(burst.pose);
  const std::vector<Pose> poses = pipeline::poses_at_mid_burst(measured, {});
  std::vector<PlacedPose> out;
  for (std::size_t i = 0; i < bursts.size(); ++i) out.push_back({bursts[i].id, bursts[i].pose.t_mid, poses[i]});
  return out;
}

}  // namespace enamel::host
