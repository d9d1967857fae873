// Step 0: the projector's response from pictures of even grey levels on a flat white target.
#pragma once

#include <optional>
#include <string>

#include "calib/model/projector_response.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

/// Share of full scale that a level's deviation may reach before fringes are no sinusoids worth calibrating with.
inline constexpr double kMaxResponseResidual = 0.05;

/// From DIR/response/grey_<level>.png, means over the middle half of the picture. Empty where the folder has none.
/// Errors: kCalibrationFolder with fewer than three levels or when the brightest is saturated or no brighter than the
/// darkest; kImageInvalid for a damaged file.
[[nodiscard]] Result<std::optional<ProjectorResponse>> read_response(const std::string& folder, double saturation_dn);

/// Error: kCalibrationRefused when the residual is above kMaxResponseResidual, or a level emits no more than the one
/// below it: such a response has no inverse.
[[nodiscard]] Result<void> check_response(const ProjectorResponse& response);

}  // namespace enamel::calib
