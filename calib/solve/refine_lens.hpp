// One lens and its poses by least squares, freeing the lens's parameters step by step. Private to calib/solve.
#pragma once

#include "calib/solve/lens_start.hpp"

namespace enamel::calib {

/// Stepwise convergence: focal lengths, k1, k2, p1 and p2, then the principal point (docs/calibration.md §4).
/// Updates lens, poses and rms_px in place.
void refine_stepwise(const std::vector<PlaneView>& views, LensStart& start);

}  // namespace enamel::calib
