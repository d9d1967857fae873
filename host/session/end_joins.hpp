// What is done about segments when a scan has ended. Private to host/session.
#pragma once

#include <vector>

#include "host/session/end_stages.hpp"
#include "host/session/segment_ledger.hpp"
#include "pipeline/register/track/join_votes.hpp"
#include "pipeline/stages/fuse_stage.hpp"
#include "pipeline/stages/track_stage.hpp"

namespace enamel::host {

/// Asks bursts of each segment that is still apart for their place once more: by now its neighbourhood may have been
/// scanned. Joins are carried out in fusion and noted.
void join_at_end(stage::TrackStage& track, stage::FuseStage& fuse, SegmentLedger& ledger,
                 const pipeline::JoinConfig& config);

struct MeasuredBurst {
  BurstId id;
  pipeline::MeasuredPose pose;
  Sight sight;
};
/// All bursts that ended up in a segment, in its frame and in order of burst.
[[nodiscard]] std::vector<MeasuredBurst> bursts_in(SegmentId root, const SinkStage& sink);
/// Their poses at mid-burst.
[[nodiscard]] std::vector<PlacedPose> at_mid_burst(const std::vector<MeasuredBurst>& bursts);

}  // namespace enamel::host
