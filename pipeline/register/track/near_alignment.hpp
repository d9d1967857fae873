// Alignment of a burst to a segment in which the hand was a moment ago: predict, align to the model's view, fall back
// to the last patch. Private to register/track.
#pragma once

#include <optional>
#include <span>

#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/track/segment_memory.hpp"
#include "pipeline/register/track/tracker_config.hpp"
#include "protocol/base/time.hpp"

namespace enamel::pipeline {

/// Stateless; refers to what its owner keeps.
class NearAlignment {
 public:
  NearAlignment(const TrackerConfig& config, const ViewCamera& camera) : config_(config), camera_(camera) {}

  /// nullopt: no start leads to an alignment that may be believed and that a hand can have reached.
  /// Precondition: segment.motion and segment.last_patch hold something.
  [[nodiscard]] std::optional<IcpResult> operator()(const SegmentMemory& segment, const PatchPyramid& pyramid,
                                                    const ModelView& view, DeviceTime t) const;

 private:
  struct Ask {
    const MotionModel& motion;
    const PatchPyramid& pyramid;
    const Pose& predicted;
    DeviceTime t;
  };
  /// From one start after the other; the first that may be believed.
  [[nodiscard]] std::optional<IcpResult> from(std::span<const Pose> starts, const ModelView& source,
                                              const Ask& ask) const;
  [[nodiscard]] bool plausible(const Pose& T_model_cam, const Ask& ask) const;

  const TrackerConfig& config_;
  const ViewCamera& camera_;
};

}  // namespace enamel::pipeline
