// What one ray of a drawn scene finds at one instant: the surface, the light that reaches it, the projector's column.
#pragma once

#include "calib/model/lens.hpp"
#include "tests/support/draw/conditions.hpp"
#include "tests/support/draw/shape.hpp"

namespace enamel::test {

struct TracedPoint {
  double depth_mm = 0;            ///< camera z; 0: no surface
  double column_px = 0;           ///< of the projector that sees the point, in light or not
  double projector_depth_mm = 0;  ///< along the projector's axis
  double light = 0;               ///< share of full well at emission 1; 0 in shadow and beside the projector's frame
  double ambient = 0;             ///< share of full well
  int face = 0;                   ///< of surface and paint: neighbours of one face are alike
  bool lit = false;
};

class Tracer {
 public:
  /// time_s: from mid-burst. Both must outlive it.
  Tracer(const Drawn& drawn, const SceneShape& shape, double time_s);

  /// ray: camera direction (x, y, 1).
  [[nodiscard]] TracedPoint trace(calib::PlanePoint ray) const;

 private:
  const Drawn& drawn_;
  const SceneShape& shape_;
  Eigen::Matrix3d to_scene_;   ///< turns camera directions into scene coordinates
  Point3 camera_, projector_;  ///< in scene coordinates
  double strength_ = 0;
};

}  // namespace enamel::test
