// How the least-squares problems of a calibration are solved. Private to calib/solve and calib/mount.
#pragma once

#include <ceres/solver.h>

namespace enamel::calib {

/// One thread: the same bits every time. To the last digits, for the covariance is taken at the solution.
[[nodiscard]] inline ceres::Solver::Options adjustment_options(ceres::LinearSolverType linear) {
  ceres::Solver::Options options;
  options.linear_solver_type = linear;
  options.num_threads = 1;
  options.max_num_iterations = 60;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace enamel::calib
