// The fused model seen from one pose: what registration aligns the next patch to. Immutable once published.
#pragma once

#include <cstdint>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/track.hpp"

namespace enamel {

/// An ideal pinhole picture: view pixel (i, j) looks along the ray (x, y, 1) of the camera's coordinates at T_model_cam
/// with x = (i * stride - cx) / fx, y = (j * stride - cy) / fy (the camera's fx fy cx cy, no distortion). So a point p
/// in camera coordinates falls on view pixel i = round((fx * p.x / p.z + cx) / stride), j likewise; no lens code is
/// needed. The maps have ceil(width / stride) x ceil(height / stride) pixels.
struct ModelView {
  bool empty = true;                  ///< nothing fused yet
  SegmentId segment = kModelSegment;  ///< whose surface this is, and whose frame "model frame" means
  std::uint64_t after_burst = 0;      ///< last burst fused into the model when this was drawn
  std::uint64_t drawing = 0;          ///< counts up with every one drawn in a scan; 0: not counted
  Pose T_model_cam = Pose::Identity();
  int stride = 1;  ///< camera pixels a view pixel, in u and v
  Map<Vec3f>
      points;  ///< model frame (mm), NaN = none; on the ray of the pixel, exact zero of the interpolated distance field
  Map<Vec3f> normals;  ///< model frame, unit, towards the viewer; NaN = none (exactly where points are)
};

}  // namespace enamel
