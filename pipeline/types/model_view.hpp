// The fused model seen from one pose: what registration aligns the next patch to. Immutable once published.
#pragma once

#include <cstdint>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"

namespace enamel {

struct ModelView {
  bool empty = true;             ///< nothing fused yet
  std::uint64_t after_burst = 0; ///< last burst fused into the model when this was drawn
  Pose T_model_cam = Pose::Identity();
  Map<Vec3f> points;             ///< model frame (mm), NaN = none; seen from T_model_cam with the camera's undistorted rays
  Map<Vec3f> normals;            ///< model frame, unit, towards the viewer
};

}  // namespace enamel
