// The calibration as a whole: start, bundle, unbiased centres, variances, outliers, bad poses, the target's shape,
// planes and the correction field.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/solve/bundle.hpp"
#include "calib/solve/observation.hpp"
#include "calib/solve/residual_field.hpp"

namespace enamel::calib {

struct PoseNote {
  std::string pose, reason;
};

enum class ShapeChoice { kAuto, kPerfect, kSolve };

struct SolveOptions {
  ShapeChoice shape = ShapeChoice::kAuto;
  ShapePrior shape_prior;                           ///< how far a real target is off its drawing
  std::array<double, 2> fringe_period_px{};         ///< of the finest fringes along u and v
  std::function<void(const std::string&)> on_step;  ///< progress; may be empty
};

/// The rig as it stood after a step: start, bundle, global (planes joined the dots), field.
struct SolveStep {
  std::string name;
  RigState state;
};

struct Solution {
  RigState state;               ///< poses in the order of `poses`
  std::vector<PoseView> poses;  ///< those that took part, with unbiased centres
  std::vector<PoseNote> rejected;
  std::vector<std::string> notes;  ///< e.g. which start was taken, singular poses, dots left out
  BundleResult result;             ///< with covariance
  BundleOptions options;           ///< of the last bundle: variance factors, shape
  std::string start_method;
  bool is_shape_solved = false;
  std::vector<SolveStep> steps;  ///< those that were taken, in their order; the last one's state is `state`
  FieldChoice field;             ///< the sizes of the correction field that were tried
};

/// `views` in the order of the poses. Errors: kCalibrationPoses (too few, too parallel, no start), kTargetMirrored,
/// kCalibrationUnits.
[[nodiscard]] Result<Solution> solve(std::vector<PoseView> views, const TargetDesign& target, const Rig& nominal,
                                     const SolveOptions& options);

}  // namespace enamel::calib
