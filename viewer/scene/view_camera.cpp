#include "viewer/scene/view_camera.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::view {

Vec3d eye(const ViewCamera& camera) { return camera.target + camera.R_model_view * Vec3d(0, 0, camera.distance_mm); }

Eigen::Matrix4f view_matrix(const ViewCamera& camera) {
  const Eigen::Matrix3d rotation = camera.R_model_view.conjugate().toRotationMatrix();
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation;
  m.topRightCorner<3, 1>() = -(rotation * eye(camera));
  return m.cast<float>();
}

Eigen::Matrix4f projection_matrix(const ViewCamera& camera, double aspect) {
  // The scene is a mouth: 200 mm around the target holds all of it. The near plane keeps 24-bit depth useful.
  const double far_mm = camera.distance_mm + 200;
  const double near_mm = std::max(1.0, camera.distance_mm - 150);
  const double f = 1.0 / std::tan(0.5 * camera.fov_y_rad);
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 0) = f / std::max(aspect, 1e-3);
  m(1, 1) = f;
  m(2, 2) = (far_mm + near_mm) / (near_mm - far_mm);
  m(2, 3) = 2 * far_mm * near_mm / (near_mm - far_mm);
  m(3, 2) = -1;
  return m.cast<float>();
}

void orbit(ViewCamera& camera, double right_rad, double down_rad) {
  const Eigen::Quaterniond turn =
      Eigen::AngleAxisd(-right_rad, Vec3d::UnitY()) * Eigen::AngleAxisd(-down_rad, Vec3d::UnitX());
  camera.R_model_view = (camera.R_model_view * turn).normalized();
}

void pan(ViewCamera& camera, double right, double down) {
  const double height_mm = 2 * camera.distance_mm * std::tan(0.5 * camera.fov_y_rad);
  camera.target += camera.R_model_view * Vec3d(-right * height_mm, down * height_mm, 0);
}

void zoom(ViewCamera& camera, double factor) {
  if (factor > 0 && std::isfinite(factor)) {
    camera.distance_mm = std::clamp(camera.distance_mm / factor, kMinDistanceMm, kMaxDistanceMm);
  }
}

}  // namespace enamel::view
