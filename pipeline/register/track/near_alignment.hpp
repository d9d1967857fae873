// Alignment of a burst to a segment in which the hand was a moment ago: predict, align to the model's view, fall back
// to the last patch. Private to register/track.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/icp/patch_view.hpp"
#include "pipeline/register/track/burst_texture.hpp"
#include "pipeline/register/track/segment_memory.hpp"
#include "pipeline/register/track/tracker_config.hpp"
#include "protocol/base/time.hpp"

namespace enamel::pipeline {

/// Refers to what its owner keeps. Remembers what it made of the model's view last: results do not depend on it.
class NearAlignment {
 public:
  NearAlignment(const TrackerConfig& config, const calib::LensValues& lens, const PatchViewer& viewer)
      : config_(config), lens_(lens), viewer_(viewer), camera_(lens) {}

  struct Burst {
    const PatchPyramid& pyramid;
    BurstTexture& texture;
    const ModelView& view;
    DeviceTime t;
  };

  /// nullopt: no start leads to an alignment that may be believed and that a hand can have reached.
  /// Precondition: segment.motion and segment.last_patch hold something.
  [[nodiscard]] std::optional<IcpResult> operator()(const SegmentMemory& segment, const Burst& burst);

 private:
  /// Poses to begin with, in their order.
  struct Starts {
    std::array<Pose, 11> poses;
    std::size_t count = 0;
    void add(const Pose& pose) { poses[count++] = pose; }
  };
  struct Ask {
    const SegmentMemory& segment;
    const Burst& burst;
    const Pose& predicted;
  };
  /// From one start after the other; the first that may be believed.
  [[nodiscard]] std::optional<IcpResult> from(std::span<const Pose> starts, const Reference& reference,
                                              const Ask& ask) const;
  /// Views are drawn anew only where the probe has moved on: one Reference serves several bursts.
  [[nodiscard]] const Reference& reference_of(const ModelView& view);
  /// Where shape leaves directions free: the pose that texture asks for along them, aligned anew from there.
  [[nodiscard]] IcpResult held_by_texture(const IcpResult& by_shape, const Reference& reference, const Ask& ask) const;
  [[nodiscard]] bool acceptable_for(const IcpResult& result, const Ask& ask) const;
  [[nodiscard]] bool plausible(const Pose& T_model_cam, const Ask& ask) const;

  const TrackerConfig& config_;
  const calib::LensValues& lens_;
  const PatchViewer& viewer_;
  ViewCamera camera_;
  Reference reference_;        ///< of the view …
  std::uint64_t drawing_ = 0;  ///< … with this ModelView::drawing
  ReferenceScratch scratch_;
};

}  // namespace enamel::pipeline
