// Six normal equations of a small motion, their weak directions, and the solution that holds those by a prior.
#pragma once

#include <Eigen/Core>

#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A small motion x = (rho*omega, tau) in mm about a centre c: p -> exp(omega)(p - c) + c + tau.
/// rho turns angles into lengths: it is the typical lever of a patch, so all six unknowns weigh alike.
[[nodiscard]] Pose apply_motion(const Vector6& x, const Vec3d& centre, double rho_mm, const Pose& T);

/// The x with apply_motion(x, centre, rho, from) == to.
[[nodiscard]] Vector6 motion_between(const Pose& from, const Pose& to, const Vec3d& centre, double rho_mm);

/// Sums over points in a fixed order: H = sum w J J^T, g = sum w J e, J = ((p - c) x n / rho, n).
struct NormalSystem {
  Matrix6 H = Matrix6::Zero();  ///< symmetric
  Vector6 g = Vector6::Zero();
  double weight = 0;

  void add(const Vector6& J, double e, double w) {
    H += w * J * J.transpose();
    g += w * e * J;
    weight += w;
  }
};

struct PriorConfig {
  double weak_eigenvalue = 0.01;  ///< of H/weight: less says next to nothing about its direction
  double stiffness = 0.005;       ///< of the prior on a direction of eigenvalue 0; falls to 0 at weak_eigenvalue
};

struct Solution {
  Vector6 x = Vector6::Zero();
  Vector6 eigenvalues = Vector6::Zero();  ///< ascending, of H/weight (dimensionless, sum <= 2 or so)
  int weak = 0;                           ///< directions below weak_eigenvalue
};

/// min over x of mean w(e + J x)^2 + sum over weak directions v of mu_v (v.(x - x_prior))^2,
/// mu = stiffness (1 - lambda/weak)^2. system.weight > 0.
[[nodiscard]] Solution solve(const NormalSystem& system, const Vector6& x_prior, const PriorConfig& config);

}  // namespace enamel::pipeline
