// What a solved rig.json says of its own uncertainty, as the mount's adjustment takes it.
#pragma once

#include <Eigen/Core>

#include "calib/model/rig.hpp"

namespace enamel::calib {

/// Covariance of rig_parameter_names() in their order; empty where the file has none, or has one that is none: other
/// names, numbers that are not finite, a negative variance in any direction.
[[nodiscard]] Eigen::MatrixXd rig_covariance_of(const Rig& rig);

}  // namespace enamel::calib
