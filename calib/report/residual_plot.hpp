// Pictures of residuals over an instrument's field and of planes over the camera's.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/judge/plane_check.hpp"

namespace enamel::calib {

struct FieldArrow {
  Eigen::Vector2d at_px{0, 0}, residual_px{0, 0};
};

/// Every residual as a thin arrow; over them the mean of each cell of 8 x 6, four times as long, red where it is more
/// than three standard errors from zero: what is left there is no noise. Inline SVG.
[[nodiscard]] std::string residual_field(const std::vector<FieldArrow>& arrows, int width_px, int height_px);

/// Heights of a board's ground over its best plane, means over 3 x 3 of the samples, colours from -limit to +limit um:
/// an <img> with the PNG in it. Error: kInternal when the picture cannot be encoded.
[[nodiscard]] Result<std::string> plane_map(const PlaneCheck& plane, int width_px, int height_px, double limit_um);

}  // namespace enamel::calib
