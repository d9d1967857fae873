// What registration says of one burst.
#pragma once

#include <cstdint>

#include "pipeline/types/geometry.hpp"

namespace enamel {

enum class TrackState : std::uint8_t {
  kStarted,      ///< first patch: defines the model frame
  kTracking,     ///< aligned to the model by ICP
  kRelocalised,  ///< found again by features, then aligned
  kLost,         ///< not placed; the patch must not be fused
};

struct TrackResult {
  TrackState state = TrackState::kLost;
  Pose T_model_cam = Pose::Identity();  ///< at mid-burst; last known when lost
  double rms_mm = 0;                    ///< point-to-plane residual of the inliers
  double overlap = 0;                   ///< share of the patch that met the model, 0…1
  int iterations = 0;
};

}  // namespace enamel
