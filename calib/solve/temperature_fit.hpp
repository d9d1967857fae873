// Drift of the optics with temperature, from calibrations of one probe taken at two temperatures or more.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/model/temperature.hpp"
#include "calib/solve/observation.hpp"

namespace enamel::calib {

struct RigAtTemperature {
  RigState state;              ///< without correction field
  Eigen::MatrixXd covariance;  ///< kRigParameters square, bundle.hpp's order
  double temp_c = 0;
};

/// What drifts: fx fy cx cy of both lenses, the relative pose. Distortion does not.
inline constexpr int kTemperatureRates = 14;

struct TemperatureFit {
  RigState state;              ///< at terms.reference_c, the mean of the temperatures
  Eigen::MatrixXd covariance;  ///< of it, bundle.hpp's order
  TemperatureTerms terms;      ///< range_c is what was measured
  /// Standard errors a kelvin: camera fx fy cx cy, projector the same (px), rotation (rad), translation (mm).
  Eigen::Matrix<double, kTemperatureRates, 1> sigma;
  double chi2 = 0;
  int degrees = 0;  ///< of freedom left: 22 a set less 36
};

/// Generalised least squares, each set weighted by its own covariance: p_i = p + (T_i - T_ref) D b, with D the fourteen
/// parameters that drift. Errors: kCalibrationPoses when there are fewer than two sets or they lie less than 3 K
/// apart; kRigInvalid for a set without covariance, with a correction field (it belongs to its own lens values) or of
/// another image size; kCalibrationRefused when chi2 exceeds what a straight line leaves by five sigma.
[[nodiscard]] Result<TemperatureFit> fit_temperature(const std::vector<RigAtTemperature>& sets);

}  // namespace enamel::calib
