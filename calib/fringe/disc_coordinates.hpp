// Projector coordinates of a disc: samples inside its image, the local fit to them, and the ripple that a projector
// which is not quite linear leaves on the phase.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "calib/fringe/phase.hpp"
#include "calib/target/disc_fit.hpp"

namespace enamel::calib {

/// One camera pixel inside a disc: projector coordinates u, v and their variances.
struct ProjectorSample {
  Eigen::Vector2d camera_px{0, 0};
  Eigen::Vector2d projector_px{0, 0};
  Eigen::Vector2d variance_px2{0, 0};
};

/// Samples at least `margin_px` inside the contour, where the edge's blur does not mix two albedos.
[[nodiscard]] std::vector<ProjectorSample> disc_samples(const CoordinateMap& u, const CoordinateMap& v,
                                                        const Ellipse& disc, double margin_px);

/// Weighted quadratic fit at a camera place: projector coordinates there, their derivative and variances. The variances
/// grow with the misfit: images noisier than they claim to be do not pass for good ones.
struct LocalMap {
  Eigen::Vector2d projector_px{0, 0};
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();  ///< d(projector px) / d(camera px)
  Eigen::Vector2d variance_px2{0, 0};
};

/// Empty with fewer than 20 samples or when they do not fix a quadratic.
[[nodiscard]] std::optional<LocalMap> fit_local_map(std::span<const ProjectorSample> samples,
                                                    const Eigen::Vector2d& at);

/// Harmonics 4 and 8 of the finest fringe per axis: projector px added to the true coordinate as
/// c0 sin 4phi + c1 cos 4phi + c2 sin 8phi + c3 cos 8phi (docs/decode.md §6).
struct Ripple {
  std::array<double, 2> period_px{};
  std::array<Eigen::Vector4d, 2> coefficients_px{Eigen::Vector4d::Zero(), Eigen::Vector4d::Zero()};

  [[nodiscard]] double at(int axis, double coordinate_px) const;
  /// sin 4phi, cos 4phi, sin 8phi, cos 8phi at a coordinate.
  [[nodiscard]] static Eigen::Vector4d harmonics(double coordinate_px, double period_px);
  void remove(std::span<ProjectorSample> samples) const;
};

/// Least squares over what the local fits of all discs leave.
[[nodiscard]] Ripple estimate_ripple(std::span<const std::vector<ProjectorSample>> discs,
                                     std::array<double, 2> period_px);

}  // namespace enamel::calib
