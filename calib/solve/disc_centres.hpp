// Measured centres with the help of a state: free of the bias of perspective and distortion, and with projector
// coordinates that lean on the shape of the map the state predicts. Private to calib/solve and calib/mount.
#pragma once

#include "calib/solve/observation.hpp"

namespace enamel::calib {

/// Renews camera_px and map of every dot; returns the largest change of camera_px, px.
/// Camera: the ellipse's centre less disc_bias. Projector: the state's prediction at that place plus the weighted mean
/// of (measured - predicted) over the disc's samples; one unknown an axis where the free quadratic of fit_local_map has
/// six, half its sigma. Gross samples (beyond 4 sigma of the disc's own scatter) are left out.
double refine_centres(std::vector<PoseView>& poses, const TargetDesign& target, const RigState& state);

}  // namespace enamel::calib
