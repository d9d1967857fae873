// One camera from pictures of a chessboard, without a projector.
#pragma once

#include <utility>

#include "calib/solve/lens_start.hpp"
#include "calib/solve/solve.hpp"
#include "calib/target/target.hpp"

namespace enamel::calib {

struct CameraSolution {
  LensStart start;  ///< lens, poses in the order of `poses`, rms
  std::vector<std::string> poses;
  std::vector<double> rms_px;      ///< of each pose
  std::vector<PoseNote> rejected;  ///< pictures in which the board was not found, poses that do not fit
};

/// Pictures of one size: names and files. A picture whose residual is more than three times the median's is left out,
/// the worst first. Errors: kCalibrationPoses (fewer than three usable pictures, all parallel, no start),
/// kTargetNotFound when no picture shows the board, kImageInvalid for a picture of another size.
[[nodiscard]] Result<CameraSolution> solve_camera(const std::vector<std::pair<std::string, std::string>>& pictures,
                                                  const TargetDesign& board);

}  // namespace enamel::calib
