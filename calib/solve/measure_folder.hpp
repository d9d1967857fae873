// All poses of a calibration folder, measured one after the other.
#pragma once

#include <functional>

#include "calib/io/response.hpp"
#include "calib/solve/measure.hpp"
#include "calib/solve/solve.hpp"

namespace enamel::calib {

struct MeasuredFolder {
  std::vector<PoseView> views;
  std::vector<PoseNote> rejected;  ///< poses that cannot be used, each with its reason
  std::vector<std::string> notes;
  PixelNoise noise;
  std::optional<ProjectorResponse> response;
  Ripple ripple;  ///< of the finest fringes, from all views
};

/// A pose that cannot be used is named in `rejected`; on its own it is no error. `on_pose` is called after each pose.
/// Errors: that of the first pose when not one can be used; those of read_response and check_response.
[[nodiscard]] Result<MeasuredFolder> measure_folder(const CalibFolder& folder, const std::function<void()>& on_pose);

/// Periods of the finest fringes along u and v, projector px.
[[nodiscard]] std::array<double, 2> finest_periods_px(const CalibFolder& folder);

}  // namespace enamel::calib
