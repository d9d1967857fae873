// One lens and its poses by least squares, freeing the lens's parameters step by step. Private to calib/solve.
#pragma once

#include "calib/solve/lens_start.hpp"

namespace enamel::calib {

/// Stepwise convergence: focal lengths, then k1, then k2, then p1 and p2, then the principal point (algorithms.md §6b).
/// Updates lens, poses and rms_px in place.
void refine_stepwise(const std::vector<PlaneView>& views, LensStart& start);

}  // namespace enamel::calib
