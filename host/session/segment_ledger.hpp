// Which segments a scan fell into, and what became of them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "pipeline/types/track.hpp"
#include "protocol/base/ids.hpp"

namespace enamel::host {

/// One segment as it was scanned, the model's first stretch included.
struct SegmentRow {
  SegmentId id = kModelSegment;
  std::uint64_t bursts = 0;  ///< placed in it while it stood for itself
  BurstId first{}, last{};
  std::optional<SegmentId> into;     ///< the segment that it was joined to
  std::optional<BurstId> joined_at;  ///< the burst that proved it; none: found after the last burst
};

/// One thread.
class SegmentLedger {
 public:
  /// The burst counts for the segment in which it stands after its joins.
  void placed(BurstId burst, const TrackResult& result);
  void joined(const SegmentJoin& join, std::optional<BurstId> at);

  /// Where a segment ended up: itself, or what it was joined to, directly or by others.
  struct Root {
    SegmentId id = kModelSegment;
    Pose T_root_segment = Pose::Identity();
  };
  [[nodiscard]] Root root_of(SegmentId segment) const;
  [[nodiscard]] std::vector<SegmentRow> rows() const;  ///< ascending id

 private:
  std::map<SegmentId, SegmentRow> rows_;
  std::map<SegmentId, SegmentJoin> joins_;
};

}  // namespace enamel::host
