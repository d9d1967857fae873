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
    const SurfacePatch patch = segments.unpack()(burst.patch);
    if (const auto join = track.seek({burst.id, id, burst.T_segment_cam}, patch)) return join;
  }
  return std::nullopt;
}

}  // namespace

void join_at_end(stage::TrackStage& track, stage::FuseStage& fuse, SegmentLedger& ledger,
                 const pipeline::JoinConfig& config) {
  // The youngest last: what older ones were joined to shows more surface then.
  for (const SegmentId id : apart_now(fuse.segments())) {
    const auto join = seek(track, fuse.segments(), id, config.at_end);
    if (!join) continue;
    fuse.segments().join(*join);
    ledger.joined(*join, std::nullopt);
  }
}

std::vector<PlacedPose> poses_in(SegmentId root, const SinkStage& sink) {
  std::vector<PlacedPose> out;
  std::vector<pipeline::MeasuredPose> measured;
  for (std::size_t i = 0; i < sink.placed.size(); ++i) {
    const SegmentLedger::Root at = sink.segments.root_of(sink.placed[i].segment);
    if (at.id != root) continue;
    measured.push_back(sink.poses[i]);
    measured.back().T_model_cam = at.T_root_segment * measured.back().T_model_cam;
    out.push_back({sink.placed[i].id, measured.back().t_mid, Pose::Identity()});
  }
  const std::vector<Pose> at_mid_burst = pipeline::poses_at_mid_burst(measured, {});
  for (std::size_t i = 0; i < out.size(); ++i) out[i].T_model_cam = at_mid_burst[i];
  return out;
}

}  // namespace enamel::host
