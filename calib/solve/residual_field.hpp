// Step 3's second half: what no lens formula explains, as a smooth correction of 1/z, kept only where it makes planes
// flatter that had no part in it.
#pragma once

#include <optional>
#include <vector>

#include "calib/solve/observation.hpp"

namespace enamel::calib {

/// Mean square distance of each pose's ground from its best plane, in units of the pixels' noise; the board's own
/// solved height is taken off. Poses without enough ground are passed over.
[[nodiscard]] std::vector<double> plane_misfits(const std::vector<PoseView>& poses, const TargetDesign& target,
                                                const RigState& state);

/// One size of the field, tried on every plane with all the others as its source.
struct FieldTrial {
  std::array<int, 3> terms{};
  double gain = 0;  ///< fall of the unseen planes' mean square distance, in units of their noise, mean over planes
  double gain_sigma = 0;      ///< standard error of that mean, from the planes' scatter
  std::vector<double> gains;  ///< of each plane
};

struct FieldChoice {
  std::optional<CorrectionField> field;  ///< absent: no size helped unseen planes by more than a standard error
  std::vector<FieldTrial> trials;
  std::size_t taken = 0;  ///< of the trials, where there is a field
};

/// Fits delta(1/z) to the ground's distances from the best planes (free in tilt and distance, so that the metric stays
/// the bundle's), for sizes up to kMaxCorrectionTerms, with a prior of some microns on each coefficient. Of the sizes
/// whose gain exceeds its standard error the smallest within a standard error of the best is fitted to all planes.
/// Needs five poses with ground; deterministic. `state` without correction.
[[nodiscard]] FieldChoice choose_field(const std::vector<PoseView>& poses, const TargetDesign& target,
                                       const RigState& state);

}  // namespace enamel::calib
