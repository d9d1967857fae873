// The virtual camera that looks at the model. OpenGL convention: x right, y up, looking along -z. mm and rad.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pipeline/types/geometry.hpp"

namespace enamel::view {

struct ViewCamera {
  Vec3d target = Vec3d::Zero();                                      ///< model frame; the point that orbiting keeps
  Eigen::Quaterniond R_model_view = Eigen::Quaterniond::Identity();  ///< columns: right, up, towards the viewer
  double distance_mm = 70;                                           ///< eye to target
  double fov_y_rad = 0.49;  ///< 28 degrees: little perspective, like a scan viewer
};

inline constexpr double kMinDistanceMm = 8;
inline constexpr double kMaxDistanceMm = 600;

[[nodiscard]] Vec3d eye(const ViewCamera& camera);
[[nodiscard]] Eigen::Matrix4f view_matrix(const ViewCamera& camera);                       ///< model to view
[[nodiscard]] Eigen::Matrix4f projection_matrix(const ViewCamera& camera, double aspect);  ///< view to clip

/// Turns about the target by the screen's axes: drag right = the model turns right, drag down = it tips towards the
/// viewer.
void orbit(ViewCamera& camera, double right_rad, double down_rad);
/// Moves by shares of the picture's height; the model follows the pointer.
void pan(ViewCamera& camera, double right, double down);
/// factor > 1 comes closer. The distance stays within kMinDistanceMm … kMaxDistanceMm.
void zoom(ViewCamera& camera, double factor);

}  // namespace enamel::view
