// What registration remembers of one segment of a scan. Private to register/track.
#pragma once

#include <memory>
#include <optional>

#include "pipeline/register/icp/texture_term.hpp"
#include "pipeline/register/track/keyframes.hpp"
#include "pipeline/register/track/motion_model.hpp"
#include "pipeline/types/model_view.hpp"
#include "pipeline/types/track.hpp"

namespace enamel::pipeline {

struct SegmentMemory {
  SegmentId id = kModelSegment;
  MotionModel motion;
  KeyframeStore keyframes;
  std::optional<ModelView> last_patch;      ///< of its last placed burst
  std::optional<TextureReference> texture;  ///< of a burst a moment ago, where shape did not determine the motion

  /// Takes over what `other` remembers. Its motion and last patch too, where `is_newer`: the hand is there.
  void absorb(SegmentMemory&& other, const Pose& T_this_other, bool is_newer);
};

}  // namespace enamel::pipeline
