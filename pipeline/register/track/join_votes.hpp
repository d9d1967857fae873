// Overlap of two segments is believed when bursts agree on it. Teeth repeat: one burst that looks like another place is
// an opinion, and a false join is the worst that registration can do.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/track.hpp"
#include "protocol/base/ids.hpp"

namespace enamel::pipeline {

struct JoinConfig {
  std::size_t votes = 3;   ///< bursts that must agree
  double agree_mm = 0.15;  ///< at the point looked at: the tolerance of a feature match; a wrong tooth is 5 mm away
  double agree_deg = 1;    ///< that far over a patch's lever of 4.5 mm is half of it
  std::size_t kept = 12;   ///< of a pair of segments, the newest
  std::size_t asked = 4;   ///< segments in which one burst is sought: the model, and others by turns. Where every burst
                           ///< is a segment of its own (tissue that moves), the time a burst takes must not grow
  std::size_t at_end = 24;  ///< bursts of a segment that are asked again when the scan ends, evenly over it
};

/// One burst's opinion: it was placed in both segments.
struct JoinVote {
  BurstId burst;
  SegmentJoin join;                 ///< segment -> into
  Vec3d looked_at = Vec3d::Zero();  ///< the point looked at, in `join.segment`
};

/// Which of the older segments one search asks: the first, and of the others as many as `most` leaves, by turns so that
/// each comes up. `turn` counts the searches.
[[nodiscard]] std::vector<SegmentId> segments_to_ask(const std::vector<SegmentId>& older, std::uint64_t turn,
                                                     std::size_t most);

/// A function of the sequence of calls alone.
class JoinVotes {
 public:
  explicit JoinVotes(const JoinConfig& config) : config_(config) {}

  /// The join, where with this burst enough agree: the mean of those. A burst votes once for a pair.
  [[nodiscard]] std::optional<SegmentJoin> add(const JoinVote& vote);
  /// Forgets what concerns a segment that is no more.
  void forget(SegmentId segment);

 private:
  [[nodiscard]] bool agree(const JoinVote& a, const JoinVote& b) const;

  JoinConfig config_;
  std::vector<JoinVote> votes_;  ///< oldest first
};

}  // namespace enamel::pipeline
