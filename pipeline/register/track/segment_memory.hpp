// What registration remembers of one segment of a scan. Private to register/track.
#pragma once

#include <memory>
#include <optional>

#include "pipeline/register/icp/texture_term.hpp"
#include "pipeline/register/track/keyframes.hpp"
#include "pipeline/register/track/motion_model.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/track.hpp"

namespace enamel::pipeline {

struct PlacedPatchRef {
  std::shared_ptr<const SurfacePatch> patch;
  Pose T_model_cam = Pose::Identity();
};

struct SegmentMemory {
  SegmentId id = kModelSegment;
  MotionModel motion;
  KeyframeStore keyframes;
  std::optional<PlacedPatchRef> last_patch;  ///< of its last placed burst; few bursts ask for the view of it
  std::optional<TextureReference> texture;   ///< of a burst a moment ago, where shape did not determine the motion

  /// Takes over what `other` remembers. Its motion and last patch too, where `is_newer`: the hand is there.
  void absorb(SegmentMemory&& other, const Pose& T_this_other, bool is_newer);
};

}  // namespace enamel::pipeline
