// Time-stamped edges of the trigger wiring. They, and not the order of arrival, say which frame saw which pattern.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/base/time.hpp"

namespace enamel::fw {

enum class EdgeKind : std::uint8_t {
  kGate,    ///< burst gate opened: the next four strobes trigger the projector. `number` is the burst's index
  kStrobe,  ///< camera strobe rising = exposure starts. `number` is the line's own count
  kT1,      ///< projector starts a pattern set (pattern 0 follows)
  kT2Rise,  ///< pattern lit …
  kT2Fall,  ///< … and dark again
};

struct Edge {
  EdgeKind kind = EdgeKind::kStrobe;
  DeviceTime t{};
  std::uint64_t number = 0;
};

/// Read by the acquisition thread only.
class EdgeStream {
 public:
  virtual ~EdgeStream() = default;
  /// Appends every edge not yet read, in any order between lines. Returns the time up to which all edges are now known.
  [[nodiscard]] virtual DeviceTime read(std::vector<Edge>& edges) = 0;
};

}  // namespace enamel::fw
