// One pass over the points of a texture at one pose: how the greys of both bursts agree, and what their gradients say.
// Private to register/icp.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/register/icp/texture_term.hpp"

namespace enamel::pipeline {

/// Along the weak directions, one each.
using AlongWeak = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

/// Points whose grey changes along the weak directions. Light across a ridge has gradients too, but none along it.
struct Sliding {
  const TextureAlignment& of;
  const WeakDirections& weak;
  TexturePoints points;
  std::vector<AlongWeak> change;  ///< of each point's own grey, a mm of motion

  /// Points that change along a direction (weights of the weak ones) by so much and more.
  [[nodiscard]] std::size_t changing(const Eigen::VectorXd& direction, double min_gradient) const;
};
[[nodiscard]] Sliding points_that_slide(const TextureAlignment& of, const Pose& T_model_cam, const WeakDirections& weak,
                                        double min_gradient);

/// The sums of one round, along the weak directions alone.
struct TextureSums {
  using Products = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
  Products H;
  AlongWeak g;
  Products own_own, own_ref, ref_ref;  ///< products of the changes along the directions, in either burst's grey
  std::vector<float> residuals;
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;  ///< of both greys, for their correlation

  [[nodiscard]] double mean_square() const;
  [[nodiscard]] double correlation() const;
  /// Of what both greys do along a direction (weights of the weak ones). What is the same all along it counts for
  /// nothing.
  [[nodiscard]] double correlation_along(const Eigen::VectorXd& direction) const;
  /// Robust standard deviation of the residuals.
  [[nodiscard]] double scale();
};

/// level: of brightness, 0 blurred, 1 fine. sigma: residual that counts half or so.
[[nodiscard]] TextureSums sum_up(const Sliding& sliding, const Pose& T_model_cam, std::size_t level, double sigma);

/// Correlation of the blurred greys, by every `stride`-th point; 0 where fewer than `min_points` meet.
[[nodiscard]] double blurred_agreement(const Sliding& sliding, const Pose& T_model_cam, std::size_t stride,
                                       std::size_t min_points);

}  // namespace enamel::pipeline
