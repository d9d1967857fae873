// How long a view of the model serves registration: most bursts differ from the one before by half a millimetre.
#pragma once

#include "pipeline/model/fuse/fuse_config.hpp"
#include "pipeline/types/model_view.hpp"
#include "pipeline/types/viewpoint.hpp"

namespace enamel::pipeline {

/// Whether `view`, published after `served` bursts so far, does for one that was placed at T_model_cam in `segment` as
/// well. looked_at: in the camera's frame, mm. An empty view never does.
[[nodiscard]] inline bool still_shows(const ModelView& view, int served, SegmentId segment, const Pose& T_model_cam,
                                      const Vec3d& looked_at, const FuseConfig& config) {
  return !view.empty && view.segment == segment && served < config.view_kept_bursts &&
         look_alike(view.T_model_cam, T_model_cam, looked_at, {config.view_kept_mm, config.view_kept_deg});
}

}  // namespace enamel::pipeline
