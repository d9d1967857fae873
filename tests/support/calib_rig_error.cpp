#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tests/support/calib_optics.hpp"
#include "tests/support/calib_scene.hpp"

namespace enamel::test {

using Eigen::Vector2d;

Vec3d measured_place(const calib::RigState& solved, const CalibScene& scene, const Vec3d& point) {
  const double up = projector_pixel(scene, point).x();
  const Vector2d pixel = pixel_of(scene.truth.camera, point);
  const Vec3d ray = ray_of(solved.camera, pixel);
  const auto at = [&](double d) { return pixel_of(solved.projector, solved.T_proj_cam * Vec3d(ray * d)).x(); };
  double depth = point.z();
  for (int i = 0; i < 20; ++i) depth += (up - at(depth)) / ((at(depth + 1e-4) - at(depth - 1e-4)) / 2e-4);
  if (solved.correction)
    depth = 1 / (1 / depth + calib::correction_at(*solved.correction, pixel.x(), pixel.y(), 1 / depth));
  return ray * depth;
}

namespace {

/// Bow of a facing plane along x and y, the larger one, over 16 mm.
double sag_um(const calib::RigState& solved, const CalibScene& scene, double z) {
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  for (double y = -5; y <= 5; y += 1)
    for (double x = -7; x <= 7; x += 1) {
      const Vec3d p = measured_place(solved, scene, {x, y, z});
      const Eigen::Matrix<double, 6, 1> j =
          (Eigen::Matrix<double, 6, 1>() << 1, x / 8, y / 8, x * x / 64, x * y / 64, y * y / 64).finished();
      h += j * j.transpose();
      b += j * 1e3 * (p.z() - z);
    }
  const Eigen::Matrix<double, 6, 1> c = h.inverse() * b;
  return std::max(std::abs(c[3]), std::abs(c[5]));
}

}  // namespace

RigError rig_error(const calib::RigState& solved, const calib::RigState& truth) {
  CalibScene scene;
  scene.truth = truth;
  return rig_error(solved, scene);
}

RigError rig_error(const calib::RigState& solved, const CalibScene& scene) {
  std::vector<Vec3d> from, to;
  for (double z = 40; z <= 56; z += 2) {
    for (double v = 0; v <= 479; v += 479.0 / 12) {
      for (double u = 0; u <= 639; u += 639.0 / 16) {
        const Vec3d q = z * ray_of(scene.truth.camera, {u, v});
        const double up = projector_pixel(scene, q).x();
        if (up < -0.5 || up > scene.truth.projector.width - 0.5) continue;
        from.push_back(measured_place(solved, scene, q));
        to.push_back(q);
      }
    }
  }
  Vec3d mean_from = Vec3d::Zero(), mean_to = Vec3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    mean_from += from[i];
    mean_to += to[i];
  }
  mean_from /= static_cast<double>(from.size());
  mean_to /= static_cast<double>(from.size());
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    cross += (from[i] - mean_from) * (to[i] - mean_to).transpose();
    spread += (from[i] - mean_from).squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d r = svd.matrixV() * svd.matrixU().transpose();
  const double scale = svd.singularValues().sum() / spread;
  std::vector<double> off, scaled;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec3d turned_point = r * (from[i] - mean_from), goal = to[i] - mean_to;
    off.push_back(1e3 * (turned_point - goal).norm());
    scaled.push_back(1e3 * (scale * turned_point - goal).norm());
  }
  std::sort(off.begin(), off.end());
  std::sort(scaled.begin(), scaled.end());
  RigError error{off[off.size() * 95 / 100], off.back(), 1e6 * (scale - 1), scaled[scaled.size() * 95 / 100]};
  for (const double z : {42.0, 48.0, 54.0}) error.sag_um = std::max(error.sag_um, sag_um(solved, scene, z));
  return error;
}

}  // namespace enamel::test
