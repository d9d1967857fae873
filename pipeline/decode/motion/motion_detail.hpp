// A rigid motion that is known, at every fourth pixel instead of every eighth and from slopes over half the reach. The
// six unknowns may rest on slopes that are wide and so little noisy; what is taken off each pixel's phase has to follow
// its surface: where a flank begins, eps changes by half of itself within a node. Private to pipeline/decode.
#pragma once

#include <vector>

#include "pipeline/decode/motion/motion_images.hpp"
#include "pipeline/decode/motion/motion_view.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"

namespace enamel::pipeline {

struct RigidMotion;

struct MotionDetailWork {
  std::vector<float> row, rate_rad, light;
};

/// Replaces rate_rad and light of `field` by nodes twice as dense (field.detail = 2); where a slope is unknown there,
/// what `field` held. images: those that the motion was found from.
void refine_motion(const RigidMotion& motion, const MotionImages& images, const RayDepth& rays, MotionDetailWork& work,
                   MotionField& field);

}  // namespace enamel::pipeline
