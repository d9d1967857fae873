#include "pipeline/register/track/segment_memory.hpp"

#include <utility>

namespace enamel::pipeline {

void SegmentMemory::absorb(SegmentMemory&& other, const Pose& T_this_other, bool is_newer) {
  keyframes.absorb(std::move(other.keyframes), T_this_other);
  if (!is_newer) return;
  motion = other.motion;
  motion.carry_into(T_this_other);
  texture = std::move(other.texture);
  if (texture) texture->T_model_cam = T_this_other * texture->T_model_cam;
  last_patch = std::move(other.last_patch);
  if (last_patch) last_patch->T_model_cam = T_this_other * last_patch->T_model_cam;
}

}  // namespace enamel::pipeline
