#include "tools/twin/render/optics_model.hpp"

#include <algorithm>

namespace enamel::twin {
namespace {

constexpr calib::DepthRange kDepthWhenUnstated{40, 56};

Pose to_pose(const std::array<std::array<double, 4>, 4>& rows) {
  Eigen::Matrix4d m;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) m(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  }
  return Pose(m);
}

}  // namespace

Instrument::Instrument(const calib::Rig& rig_values, const ProjectorConfig& projector_config)
    : rig(rig_values),
      camera(rig_values.camera),
      projector(rig_values.projector),
      T_proj_cam(to_pose(rig_values.T_proj_cam)),
      light(calib::pattern_levels(rig_values), projector_config,
            rig_values.depth_range.value_or(kDepthWhenUnstated).near_mm,
            rig_values.depth_range.value_or(kDepthWhenUnstated).far_mm,
            // Nearer bodies are blurred by more pixels: half as many again are kept.
            1.5 * projector_config.spread_mm * std::max(rig_values.projector.fx, rig_values.projector.fy) /
                rig_values.depth_range.value_or(kDepthWhenUnstated).near_mm) {}

}  // namespace enamel::twin
