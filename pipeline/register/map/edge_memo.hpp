// Edges that were measured while the scan went on, so that the map after it measures none of them again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "pipeline/register/map/bow_factors.hpp"
#include "pipeline/register/map/pose_graph.hpp"
#include "protocol/base/ids.hpp"

namespace enamel::pipeline {

/// An edge is a function of its bursts, of where it starts and of which shades count as soft: what is found here is to
/// the bit what would be measured. Of one rig and one configuration. find() from any number of threads while nobody
/// keeps.
class EdgeMemo {
 public:
  struct Bursts {
    BurstId i, j;
  };
  struct Measured {
    std::optional<MapEdge> edge;  ///< none: the two have too little in common. Its i, j and loop are the asker's
    EdgeBow bow;
  };

  /// Edges that were measured with another limit are forgotten.
  void measured_with(std::uint8_t soft_below);
  /// `start`: T_j_i, to the bit.
  [[nodiscard]] std::optional<Measured> find(Bursts of, const Pose& start) const;
  /// Instead of what was measured between them from elsewhere.
  void keep(Bursts of, const Pose& start, const Measured& measured);
  [[nodiscard]] std::size_t size() const noexcept { return entries_.size(); }

 private:
  struct Entry {
    Pose start;
    Measured measured;
  };
  std::map<std::pair<std::uint64_t, std::uint64_t>, Entry> entries_;
  std::optional<std::uint8_t> soft_below_;
};

}  // namespace enamel::pipeline
