// What OpenCV makes of the same poses: its stereo calibration and its circle detector.
#pragma once

#include <vector>

#include "calib/io/calib_folder.hpp"
#include "calib/solve/observation.hpp"

namespace enamel::bench {

struct OpenCvRig {
  calib::RigState state;                           ///< without poses
  double rms_camera_px = 0, rms_projector_px = 0;  ///< sqrt(mean(dx² + dy²))
};

/// calibrateCamera of both instruments, then stereoCalibrate from there; k3 fixed at 0, the target taken as perfect.
/// Uses camera_px and map.projector_px of every dot, outliers too.
[[nodiscard]] OpenCvRig stereo_calibrate(const std::vector<calib::PoseView>& poses, const calib::TargetDesign& target,
                                         const calib::Rig& nominal);

/// Centre by SimpleBlobDetector with its default parameters, findCirclesGrid's own, of the spot nearest to each dot;
/// projector coordinates there from a local fit to the dot's samples. Dots that it does not find are left out.
[[nodiscard]] calib::PoseView detector_view(const calib::PoseFrames& frames, const calib::PoseView& ours);

}  // namespace enamel::bench
