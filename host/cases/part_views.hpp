// Pictures of a part from all sides, as a camera would take them, and what can be recognised in them.
#pragma once

#include <vector>

#include "host/cases/part_surface.hpp"
#include "pipeline/register/feature/surface_features.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::host {

struct ViewShape {
  int size_px = 176;        ///< square
  double px_per_mm = 7.2;   ///< chosen: at the target; pixels as wide as the features' grid
  double distance_mm = 60;  ///< chosen: of the camera from its target
  double reach_mm = 20;     ///< chosen: drawn before and behind the target: deeper than any vestibule
  double apart_mm = 9;      ///< chosen: targets; so that every place is well inside of a picture
  double apart_deg = 55;    ///< chosen: or directions
  int max_features = 80;    ///< chosen: a picture; the votes cost the square of it
};

/// z towards the surface.
struct PartView {
  Pose T_part_view = Pose::Identity();
  Vec3d target = Vec3d::Zero();  ///< part's frame
  std::vector<pipeline::SurfaceFeature> features;
};

/// The surface nearest to the camera; surface seen from behind hides what lies behind it, and is none itself.
[[nodiscard]] SurfacePatch draw_part(const PartSurface& part, const Pose& T_part_view, const ViewShape& shape);

/// Square to the surface, spread until every place of it is seen. Pure, deterministic.
[[nodiscard]] std::vector<PartView> views_of(const PartSurface& part, const ViewShape& shape);

}  // namespace enamel::host
