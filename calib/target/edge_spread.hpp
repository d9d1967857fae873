// How a straight edge between two levels shows in square pixels.
#pragma once

#include <Eigen/Core>

namespace enamel::calib {

/// Two cameras: one whose lens blurs the light before the pixels integrate it, and one that is blurred after them (or
/// rendered so). Below a blur of 0.8 px they differ by some per cent of the step, enough to move a centre by 0.004 px
/// with its place in the pixel.
enum class EdgeModel { kLensThenPixel, kPixelThenTaps };

struct EdgeSpread {
  double cover = 0;        ///< share of the inner level, 0…1
  double by_distance = 0;  ///< d cover / d distance, 1/px
  double by_blur = 0;      ///< d cover / d blur, 1/px
};

/// A pixel whose centre lies `distance_px` inside an edge of unit normal `normal`; `blur_px` is the Gaussian's sigma
/// (for kPixelThenTaps of its samples at whole pixels), the pixel's own square not included. `curvature_per_px` is that
/// of the edge, positive where the inside is convex: to first order it shifts what is averaged. Exact for straight
/// edges: the square's shadow along the normal is two boxes of widths |nx| and |ny|, a Gaussian through two boxes is a
/// second difference of its second integral.
[[nodiscard]] EdgeSpread edge_spread(EdgeModel model, double distance_px, const Eigen::Vector2d& normal, double blur_px,
                                     double curvature_per_px = 0);

}  // namespace enamel::calib
