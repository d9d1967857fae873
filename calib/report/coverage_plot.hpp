// Pictures of where a set of poses was, and of what the planes say over the depth. Inline SVG.
#pragma once

#include <string>

#include "calib/judge/judgement.hpp"

namespace enamel::calib {

/// All dots over the camera's image, coloured by their depth.
[[nodiscard]] std::string field_coverage(const Solution& solution, const TargetDesign& target, DepthRange range);

/// Every pose by the direction and angle of its tilt, coloured by its depth; the ring of 15 to 35 degrees is where most
/// of them should be.
[[nodiscard]] std::string tilt_coverage(const Solution& solution, const TargetDesign& target, DepthRange range);

/// Depths of the nearest and farthest dot of each pose, beside the measuring range.
[[nodiscard]] std::string depth_coverage(const Solution& solution, const TargetDesign& target, DepthRange range);

/// Sag along x and y and twist of each plane over its depth, and the judged values with two standard errors.
[[nodiscard]] std::string shape_chart(const Judgement& judgement, DepthRange range, double limit_um);

/// Tilt of a pose's normal against the camera's axis, degrees.
[[nodiscard]] double tilt_deg(const Pose& T_cam_target);

}  // namespace enamel::calib
