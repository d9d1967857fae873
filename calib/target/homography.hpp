// Plane-to-plane projective maps.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

namespace enamel::calib {

/// H x (homogeneous), divided.
[[nodiscard]] inline Eigen::Vector2d map_point(const Eigen::Matrix3d& h, const Eigen::Vector2d& p) {
  const Eigen::Vector3d q = h * p.homogeneous();
  return q.hnormalized();
}

/// to ~ H from, by the normalised direct linear transform (Hartley and Zisserman, alg. 4.2), H(2,2) = 1. Empty for
/// fewer than four points, for collinear ones, and for spans of different length.
[[nodiscard]] std::optional<Eigen::Matrix3d> fit_homography(std::span<const Eigen::Vector2d> from,
                                                            std::span<const Eigen::Vector2d> to);

}  // namespace enamel::calib
