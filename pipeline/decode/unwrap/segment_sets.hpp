// Which segments hang together: neighbourhood and disjoint sets of a list of segments.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "pipeline/decode/unwrap/cells.hpp"

namespace enamel::pipeline {

/// Calls visit(other) for the segments linked to segment i of the list that come before it, and for those above and
/// below.
template <class Visit>
void each_neighbour(const Segment& segment, std::size_t i, Visit visit) {
  if (segment.joined && !segment.kink) visit(i - 1);
  if (segment.up >= 0) visit(static_cast<std::size_t>(segment.up));
  if (segment.down >= 0) visit(static_cast<std::size_t>(segment.down));
}

/// Disjoint sets; the first of a set in the list is its root. Uses the caller's memory, for as long as that lives.
class SegmentSets {
 public:
  SegmentSets(std::size_t segments, std::vector<std::int32_t>& parent) : parent_(parent) {
    parent_.resize(segments);
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  std::size_t root(std::size_t i) {
    while (static_cast<std::size_t>(parent_[i]) != i) {
      parent_[i] = parent_[static_cast<std::size_t>(parent_[i])];
      i = static_cast<std::size_t>(parent_[i]);
    }
    return i;
  }

  void unite(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    if (a != b) parent_[std::max(a, b)] = static_cast<std::int32_t>(std::min(a, b));
  }

 private:
  std::vector<std::int32_t>& parent_;
};

}  // namespace enamel::pipeline
