#include "host/session/segment_ledger.hpp"

namespace enamel::host {

void SegmentLedger::placed(BurstId burst, const TrackResult& result) {
  for (const SegmentJoin& join : result.joins) joined(join, burst);
  SegmentRow& row = rows_[result.segment];
  if (row.bursts++ == 0) row.first = burst;
  row.id = result.segment;
  row.last = burst;
}

void SegmentLedger::joined(const SegmentJoin& join, std::optional<BurstId> at) {
  joins_[join.segment] = join;
  SegmentRow& row = rows_[join.segment];
  row.id = join.segment;
  row.into = join.into;
  row.joined_at = at;
}

SegmentLedger::Root SegmentLedger::root_of(SegmentId segment) const {
  Root root{segment, Pose::Identity()};
  // Joins lead to smaller numbers: this ends.
  for (auto found = joins_.find(segment); found != joins_.end(); found = joins_.find(root.id)) {
    root.T_root_segment = found->second.T_into_segment * root.T_root_segment;
    root.id = found->second.into;
  }
  return root;
}

std::vector<SegmentRow> SegmentLedger::rows() const {
  std::vector<SegmentRow> out;
  for (const auto& [id, row] : rows_) out.push_back(row);
  return out;
}

}  // namespace enamel::host
