// A ball around something of the model.
#pragma once

#include "pipeline/types/geometry.hpp"

namespace enamel::view {

struct Ball {
  Vec3d centre = Vec3d::Zero();  ///< mm
  double radius = 0;             ///< mm
};

}  // namespace enamel::view
