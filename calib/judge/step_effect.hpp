// What each step of the solution did to the planes: start, bundle, global, field.
#pragma once

#include <string>
#include <vector>

#include "calib/judge/plane_check.hpp"
#include "calib/solve/solve.hpp"

namespace enamel::calib {

struct StepEffect {
  std::string step;
  std::size_t points = 0;
  double plane_rms_um = 0, plane_rms_sigma_um = 0;  ///< of all planes together, and its standard error
  double plane_p95_um = 0;                          ///< 95th percentile of the distances, mean over the planes
  double sag_um = 0, sag_sigma_um = 0;              ///< the largest |sag| or |twist| at 1/8, 1/2, 7/8 of the depth
};

/// Of `solution.steps`, on the ground of `views`: best of poses that had no part in the solution; the correction field
/// flatters the others.
[[nodiscard]] std::vector<StepEffect> step_effects(const Solution& solution, const std::vector<PoseView>& views,
                                                   const TargetDesign& target, const Ripple& ripple, DepthRange range);

}  // namespace enamel::calib
