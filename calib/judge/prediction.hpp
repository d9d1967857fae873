// What the covariance of a solved rig says about its geometry over the measuring volume.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/judge/volume.hpp"

namespace enamel::calib {

/// Draws behind a quantile: the 99th percentile of so many is known to 3 %.
inline constexpr int kPredictionDraws = 2000;

/// Of what is told as "at most": one calibration in a hundred exceeds it. Nothing in a set tells which one, since what
/// least squares leave over says nothing about the part of the noise that the parameters took up.
inline constexpr double kBoundQuantile = 0.99;

/// Draws of the rig's parameters (bundle.hpp's order) from their covariance; what each draw does to the figures of
/// compare_rigs, to first order in the parameters' errors. Deterministic in its arguments; const calls are thread-safe.
class Prediction {
 public:
  /// All figures are zero where the projector reaches no point of the volume.
  Prediction(const RigState& state, const Eigen::MatrixXd& covariance, DepthRange range, int draws = kPredictionDraws);

  /// Of each figure's magnitude the quantile over the draws: 0.5 is what to expect, kBoundQuantile a bound.
  [[nodiscard]] VolumeDifference at(double quantile) const;

 private:
  std::array<double, 3> depth_mm_;
  std::vector<VolumeDifference> draws_;
};

}  // namespace enamel::calib
