// A burst as the map knows it.
#pragma once

#include "pipeline/types/geometry.hpp"
#include "protocol/base/ids.hpp"
#include "protocol/base/time.hpp"

namespace enamel::pipeline {

/// A placed burst. Its pose is in the model's frame.
struct MapBurst {
  DeviceTime t_mid{};
  Pose T_model_cam = Pose::Identity();
  BurstId id = {};  ///< by which an EdgeMemo knows it
};

}  // namespace enamel::pipeline
