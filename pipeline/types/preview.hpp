// What a person at the screen is shown of a scan, live or played back. Immutable once published; shared, never copied.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/model_snapshot.hpp"
#include "pipeline/types/sight.hpp"
#include "pipeline/types/track.hpp"
#include "protocol/base/append_log.hpp"
#include "protocol/base/ids.hpp"

namespace enamel {

enum class ScanState : std::uint8_t { kWaitingForProbe, kScanning, kPaused, kProbeLost, kRefining, kFinished };

/// captured = lost_on_wire + incomplete + shed + accepted, accepted = fused + rejected once everything has been worked
/// off.
struct PreviewCounters {
  std::uint64_t captured = 0;
  std::uint64_t fused = 0;
  std::uint64_t rejected = 0;
  std::uint64_t shed = 0;
  std::uint64_t incomplete = 0;
  std::uint64_t lost_on_wire = 0;
  std::uint64_t accepted = 0;
};

/// One stage of the pipeline at work.
struct StageFigures {
  std::string name;
  double median_ms = 0, p95_ms = 0;                                         ///< of its work on one burst
  double rate_hz = 0;                                                       ///< bursts that left it
  double busy = 0;                                                          ///< share of the time, 0…1
  std::uint64_t queue_depth = 0, queue_high_water = 0, queue_capacity = 0;  ///< of its inputs
  std::string waits_for;  ///< most: "decode0", "room in track", "a worker"; empty: nothing
};
struct PipelineFigures {
  std::vector<StageFigures> stages;  ///< those that work on bursts, in their order
  std::string bottleneck;            ///< one line: what sets the rate
};

/// What the pipeline shows after each burst.
struct BurstPreview {
  BurstId burst{};
  bool placed = false;  ///< `track` and `T_model_cam` hold; false before the first burst
  TrackState track = TrackState::kLost;
  double track_overlap = std::numeric_limits<double>::quiet_NaN();  ///< TrackResult::overlap, 0…1; NaN = unknown
  Pose T_model_cam = Pose::Identity();  ///< in the frame of `segment`, at mid-burst; last known when lost
  bool undetermined = false;            ///< neither shape nor texture told the motion: TrackResult::undetermined
  std::string rejected;                 ///< why this burst was, or empty
  Sight sight;                          ///< of the newest placed burst, its trouble as the last ones agree on
  SegmentId segment = kModelSegment;    ///< that `T_model_cam` and `model` are of: another than 0 stands apart
  double surface_distance_mm =
      std::numeric_limits<double>::quiet_NaN();   ///< median depth of this burst, NaN = none seen
  std::shared_ptr<const Map<std::uint8_t>> live;  ///< fringe-free 8-bit texture of this burst, or null
  std::shared_ptr<const ModelSnapshot> model;     ///< of that segment, or null while nothing is fused
  std::shared_ptr<const ModelSnapshot> whole;     ///< the model while a segment apart is scanned, else null …
  Pose T_model_return = Pose::Identity();         ///< … and where the probe was last in it: the place to return to
};

/// The newest burst and the session around it.
struct PreviewFrame : BurstPreview {
  ScanState state = ScanState::kWaitingForProbe;
  AppendLog<Vec3f>::View trail;  ///< path of the probe so far, model frame; NaN where it breaks
  PreviewCounters counters;
  double rate_hz = 0;      ///< fused bursts a second
  double latency_ms = 0;   ///< last exposure to the screen, without one to fused, median so far; 0: unknown, as played
  double refined = 0;      ///< share of the refinement after the scan that is done
  std::string result;      ///< of a finished scan: how surely its distances are known, or empty
  std::string message;     ///< empty, or what is wrong with its cause and remedy (line breaks allowed)
  bool simulated = false;  ///< the probe is a twin or a player: shown as a badge on every picture
  std::shared_ptr<const PipelineFigures> pipeline;  ///< or null while nothing runs
};

}  // namespace enamel
