// One burst of a scan as the self-check takes it: its surface thinned to cells of 2 x 2 pixels.
#pragma once

#include <limits>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::calib {

inline constexpr int kDriftCell_px = 2;

/// What one cell says of the surface; camera frame, mm.
struct SurfaceCell {
  Vec3f point =
      Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());  ///< mean of its pixels; NaN: nothing to trust
  Vec3f normal = Vec3f::Zero();                                  ///< unit, towards the camera
  float sigma_mm = 0;                                            ///< of the point along z
  /// Mean depth of the cells around it, itself left out. A derivative taken at the point's own depth would share its
  /// noise with the residual, and the weakest figure of the adjustment would be off by ten of its standard errors.
  float depth_around_mm = 0;
};

struct DriftView {
  Map<SurfaceCell> cells;
  Pose T_model_cam = Pose::Identity();  ///< where registration put it: a start, to 0.1 mm and 1 mrad
};

/// Fills depth_around_mm of all cells from their points.
void fill_depths_around(DriftView& view);

/// Cells without all four pixels, with a step of depth inside or seen at more than 60 degrees to the normal are left
/// empty. Pure.
[[nodiscard]] DriftView drift_view(const SurfacePatch& patch, const Pose& T_model_cam);

}  // namespace enamel::calib
