// Everything about the simulated instrument that a render needs, and where it stands during one burst.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "calib/model/rig.hpp"
#include "tools/twin/optics/lamp.hpp"
#include "tools/twin/optics/lens.hpp"
#include "tools/twin/optics/projector.hpp"
#include "tools/twin/optics/sensor.hpp"

namespace enamel::twin {

using Pose = Eigen::Isometry3d;

struct LightConfig {
  bool falloff = true;              ///< cos^4 of both lenses and 1/r^2; off: constant
  bool shadow = true;               ///< off: light passes through the surface
  double ambient = 0.01;            ///< added radiance, times albedo, relative to full well
  double reference_mm = 44;         ///< level 255 on albedo 0.8 facing the probe at this distance …
  double reference_fraction = 0.8;  ///< … fills this part of the full well
  LampConfig lamp;
};

struct RenderConfig {
  int grid = 2;                   ///< grid*grid samples a pixel and frame
  bool every_shadow_ray = false;  ///< also where the samples about agree on light or shade
  LightConfig light;
};

/// T_model_cam at the sub-instants of each frame: poses[frame][instant], grid*grid of them in order of time, and at
/// mid-burst.
struct BurstPoses {
  std::array<std::vector<Pose>, 4> frames;
  Pose mid = Pose::Identity();
  bool is_static = false;  ///< all equal: traced once for the four frames
};

/// Rig values turned into the twin's lenses and light.
struct Instrument {
  Instrument(const calib::Rig& rig, const ProjectorConfig& projector_config);
  calib::Rig rig;
  Lens camera, projector;
  Pose T_proj_cam = Pose::Identity();
  ProjectorLight light;
};

}  // namespace enamel::twin
