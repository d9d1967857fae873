// A stop of the desktop scanner as registration takes it: one surface patch, and where the axes stood.
#pragma once

#include "calib/model/mount.hpp"
#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/map/map_edge.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// Of its patch, what belongs to table and holder taken out. All in the camera's frame.
struct Stop {
  calib::AxisAngles angles;
  MapNode node;
  PatchPyramid pyramid;          ///< for laying from afar
  Vec3d centre = Vec3d::Zero();  ///< of what is seen
};

}  // namespace enamel::pipeline
