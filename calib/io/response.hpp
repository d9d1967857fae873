// Step 0: the projector's response from pictures of even grey levels on a flat white target.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::calib {

/// Share of full scale that a level's deviation may reach before fringes are no sinusoids worth calibrating with.
inline constexpr double kMaxResponseResidual = 0.05;

struct ProjectorResponse {
  std::vector<int> level;        ///< rising, 0…255
  std::vector<double> emission;  ///< relative, 0 at the first level, 1 at the last
  double residual = 0;           ///< largest distance from a straight line, share of full scale
};

/// From DIR/response/grey_<level>.png, means over the middle half of the picture. Empty where the folder has none.
/// Errors: kCalibrationFolder with fewer than three levels or when the brightest is saturated or no brighter than the
/// darkest; kImageInvalid for a damaged file.
[[nodiscard]] Result<std::optional<ProjectorResponse>> read_response(const std::string& folder, double saturation_dn);

/// Error: kCalibrationRefused when the residual is above kMaxResponseResidual.
[[nodiscard]] Result<void> check_response(const ProjectorResponse& response);

}  // namespace enamel::calib
