// From the images of a pose to its dots: find, order, fit, decode.
#pragma once

#include "calib/io/calib_folder.hpp"
#include "calib/solve/observation.hpp"

namespace enamel::calib {

/// Everything of a pose that does not depend on the other poses. camera_px = the ellipse's centre. Thread-safe.
/// A coded board may be seen in part and without fringes: dots without projector coordinates then have no samples, and
/// there is no ground.
/// Errors: those of find_dot_grid; kCalibrationPoses when the pose is blurred, saturated, dark, or its fringes do not
/// reach the dots (the detail says which).
[[nodiscard]] Result<PoseView> measure_pose(const PoseFrames& frames, const TargetDesign& target,
                                            const PixelNoise& image_noise, double saturation_dn,
                                            std::array<int, 2> projector_size_px, EdgeModel edges);

/// Which of the two edge models the discs of a pose follow: the one with the smaller misfit. Errors: those of
/// find_dot_grid.
[[nodiscard]] Result<EdgeModel> choose_edge_model(const PoseFrames& frames, const TargetDesign& target,
                                                  const PixelNoise& image_noise);

/// Pixel noise from the images themselves, for rigs whose rig.json states none: variance of white over neighbouring
/// pixels, free of any plane, in bins of brightness, fitted by a line (docs/calibration.md §3).
[[nodiscard]] PixelNoise estimate_noise(const PoseFrames& frames);

}  // namespace enamel::calib
