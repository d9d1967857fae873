// What registration says of one burst.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/texture_picture.hpp"

namespace enamel {

/// A stretch of a scan with a frame of its own: bursts that hang together. 0 is the model; others are numbered in the
/// order in which they began.
using SegmentId = std::uint32_t;
inline constexpr SegmentId kModelSegment = 0;

enum class TrackState : std::uint8_t {
  kStarted,      ///< first patch of a segment: defines its frame
  kTracking,     ///< aligned to its segment by ICP
  kRelocalised,  ///< with this burst its place in an older segment was found or proven
  kLost,         ///< not placed: too little surface to begin anything with; the patch must not be fused
};

/// Overlap is proven: what stood in `segment` stands in `into` from now on. into < segment.
struct SegmentJoin {
  SegmentId segment = 0;
  SegmentId into = 0;
  Pose T_into_segment = Pose::Identity();
};

struct TrackResult {
  TrackState state = TrackState::kLost;
  Pose T_model_cam = Pose::Identity();  ///< in the frame of `segment`, at mid-burst; last known when lost
  double rms_mm = 0;                    ///< point-to-plane residual of the inliers
  double overlap = 0;                   ///< share of the patch that met the model, 0…1
  int iterations = 0;
  SegmentId segment = kModelSegment;  ///< after `joins`
  std::vector<SegmentJoin> joins;     ///< that this burst proves, to be carried out before it is fused
  int undetermined = 0;  ///< directions that neither shape nor texture held: the pose along them is guessed
  std::shared_ptr<const TexturePicture> texture;  ///< where shape alone did not determine the motion, else null
};

}  // namespace enamel
