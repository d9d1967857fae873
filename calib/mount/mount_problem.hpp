// The mount's least-squares problem: its blocks, its residuals, and what their derivatives say of the solution's
// covariance. Private to calib/mount.
#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/mount/mount_cost.hpp"
#include "calib/mount/stops.hpp"

namespace enamel::calib {

inline constexpr double kDotHuber = 4.5;  ///< of a dot's four whitened residuals

/// Sigmas of what the stops bring of their own.
struct StopPriors {
  std::array<double, 2> angle_rad{};
  double shift_mm = 0;
  double harmonic_rad = 0;
  double dots = 1;  ///< factor of the dots' stated variances
};

struct MountBlocks {
  LineBlock rotation{}, swing{};
  DriveBlock drive{};
  MotionBlock board{};
  std::vector<StopBlock> stops;

  [[nodiscard]] std::vector<double*> all();  ///< in the covariance's order
};

/// Everything that the residuals point into while a problem lives.
struct MountSetting {
  std::vector<StopModel> models;
  LensBlock camera{}, projector{};
  MotionBlock relative{};
  double dots = 1;  ///< factor of their variances
};

[[nodiscard]] MountSetting setting_of(const std::vector<MountStop>& stops, const RigState& rig,
                                      const std::array<LineBase, 2>& base, double dots);

[[nodiscard]] MountDotCost cost_of(const DotView& dot, const TargetDesign& target, const MountSetting& setting,
                                   std::size_t stop);

/// All dots and priors, over `b`.
void build_problem(const std::vector<MountStop>& stops, const TargetDesign& target, const StopPriors& priors,
                   const MountSetting& setting, ceres::Problem& problem, MountBlocks& b);

/// Inverse of the normal matrix at `b`, all blocks in order; empty where it has none.
[[nodiscard]] Eigen::MatrixXd inverse_normal(ceres::Problem& problem, MountBlocks& b);

/// Product of the dots' derivatives by the blocks and by the rig's parameters (bundle.hpp's order, a column each).
[[nodiscard]] Eigen::MatrixXd rig_coupling(const std::vector<MountStop>& stops, const TargetDesign& target,
                                           MountSetting setting, MountBlocks b);

}  // namespace enamel::calib
