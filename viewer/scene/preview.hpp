// What the session publishes per burst for a person to look at. Immutable once published; shared, never copied.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/model_snapshot.hpp"
#include "pipeline/types/track.hpp"
#include "protocol/base/ids.hpp"

namespace enamel::view {

enum class ScanState : std::uint8_t { kWaitingForProbe, kScanning, kPaused, kProbeLost, kFinished };

/// captured = lost_on_wire + incomplete + shed + fused + rejected once everything has been worked off.
struct PreviewCounters {
  std::uint64_t captured = 0;
  std::uint64_t fused = 0;
  std::uint64_t rejected = 0;
  std::uint64_t shed = 0;
  std::uint64_t incomplete = 0;
  std::uint64_t lost_on_wire = 0;
};

struct PreviewFrame {
  BurstId burst{};
  ScanState state = ScanState::kWaitingForProbe;
  bool placed = false;  ///< `track` and `T_model_cam` hold; false before the first burst
  TrackState track = TrackState::kLost;
  Pose T_model_cam = Pose::Identity();  ///< at mid-burst; last known when lost
  double surface_distance_mm =
      std::numeric_limits<double>::quiet_NaN();   ///< median depth of this burst, NaN = none seen
  std::shared_ptr<const Map<std::uint8_t>> live;  ///< fringe-free 8-bit texture of this burst, or null
  std::shared_ptr<const ModelSnapshot> model;     ///< or null while nothing is fused
  double track_overlap = std::numeric_limits<double>::quiet_NaN();  ///< TrackResult::overlap, 0…1; NaN = unknown
  std::shared_ptr<const std::vector<Vec3f>>
      trail;  ///< path so far (trail_point of every placed burst); null: the viewer collects it
  PreviewCounters counters;
  double rate_hz = 0;      ///< fused bursts a second, as measured by the session
  double latency_ms = 0;   ///< last exposure to publication of this frame
  std::string message;     ///< empty, or what is wrong with its cause and remedy (line breaks allowed)
  bool simulated = false;  ///< the probe is a twin or a player: shown as a badge on every picture
};

}  // namespace enamel::view
