#include <Eigen/Dense>
#include <cmath>

#include "calib/model/lens.hpp"
#include "calib/solve/lens_start.hpp"
#include "calib/solve/refine_lens.hpp"
#include "calib/target/homography.hpp"

namespace enamel::calib {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Row of Zhang's constraint h_i' B h_j, B symmetric as (B11 B12 B22 B13 B23 B33).
Vector6d constraint(const Eigen::Matrix3d& h, int i, int j) {
  const Eigen::Vector3d p = h.col(i), q = h.col(j);
  return (Vector6d() << p[0] * q[0], p[0] * q[1] + p[1] * q[0], p[1] * q[1], p[2] * q[0] + p[0] * q[2],
          p[2] * q[1] + p[1] * q[2], p[2] * q[2])
      .finished();
}

/// Focal lengths and centre from the image of the absolute conic; false when it is not one.
bool lens_from_conic(const Vector6d& b, LensValues& lens) {
  const double det = b[0] * b[2] - b[1] * b[1];
  if (!(std::abs(det) > 0)) return false;
  const double v0 = (b[1] * b[3] - b[0] * b[4]) / det;
  const double lambda = b[5] - (b[3] * b[3] + v0 * (b[1] * b[3] - b[0] * b[4])) / b[0];
  const double fx2 = lambda / b[0], fy2 = lambda * b[0] / det;
  if (!(fx2 > 0 && fy2 > 0)) return false;
  lens.fx = std::sqrt(fx2);
  lens.fy = std::sqrt(fy2);
  lens.cx = -b[3] * fx2 / lambda;
  lens.cy = v0;
  return std::isfinite(lens.fx) && std::isfinite(lens.fy) && std::isfinite(lens.cx) && std::isfinite(lens.cy);
}

}  // namespace

Result<std::vector<Pose>> poses_for_lens(const std::vector<PlaneView>& views, const LensValues& lens) {
  std::vector<Pose> poses;
  for (const PlaneView& view : views) {
    std::vector<Eigen::Vector2d> rays;
    for (const auto& p : view.image_px) {
      const PlanePoint ray = undistort(lens, {p.x(), p.y()});
      rays.emplace_back(ray.x, ray.y);
    }
    auto h = fit_homography(view.target_mm, rays);
    if (!h) return fail(ErrorCode::kCalibrationPoses, "pose " + view.name + ": its points fix no plane");
    const double scale = 2 / (h->col(0).norm() + h->col(1).norm());
    Eigen::Matrix3d m = *h * scale;
    if (m(2, 2) < 0) m = -m;
    Eigen::Matrix3d r;
    r << m.col(0), m.col(1), m.col(0).cross(m.col(1));
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Pose pose = Pose::Identity();
    pose.linear() = svd.matrixU() * svd.matrixV().transpose();
    pose.translation() = m.col(2);
    poses.push_back(pose);
  }
  return poses;
}

Result<LensStart> zhang_start(const std::vector<PlaneView>& views, const LensValues& design) {
  // Pixels scaled to the image's half width: the conic's entries then are of one order.
  const double scale = 2.0 / design.width;
  Eigen::Matrix3d to_unit;
  to_unit << scale, 0, -1, 0, scale, -0.5 * scale * design.height, 0, 0, 1;
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  for (const PlaneView& view : views) {
    const auto h = fit_homography(view.target_mm, view.image_px);
    if (!h) return fail(ErrorCode::kCalibrationPoses, "pose " + view.name + ": its points fix no plane");
    Eigen::Matrix3d unit = to_unit * *h;
    unit /= unit.col(0).norm();
    const Vector6d orthogonal = constraint(unit, 0, 1);
    const Vector6d equal = constraint(unit, 0, 0) - constraint(unit, 1, 1);
    normal += orthogonal * orthogonal.transpose() + equal * equal.transpose();
  }
  normal(1, 1) += normal.trace();  // no skew
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(normal);
  LensStart start{.method = "Zhang", .lens = design, .T_lens_target = {}, .rms_px = 0, .singular_poses = {}};
  Vector6d conic = solver.eigenvectors().col(0);
  if (conic[0] < 0) conic = -conic;
  LensValues unit;
  if (!lens_from_conic(conic, unit))
    return fail(ErrorCode::kCalibrationPoses, "Zhang: the homographies share no camera; the poses are too alike");
  start.lens.fx = unit.fx / scale;
  start.lens.fy = unit.fy / scale;
  start.lens.cx = (unit.cx + 1) / scale;
  start.lens.cy = (unit.cy + 0.5 * scale * design.height) / scale;
  start.lens.dist = {0, 0, 0, 0, design.dist[4]};
  ENAMEL_TRY_ASSIGN(start.T_lens_target, poses_for_lens(views, start.lens));
  refine_stepwise(views, start);
  return start;
}

Result<LensStart> best_start(const std::vector<PlaneView>& views, const LensValues& design) {
  auto zhang = zhang_start(views, design);
  auto rac = rac_start(views, design);
  if (!zhang && !rac) return fail(ErrorCode::kCalibrationPoses, zhang.error().detail + "; " + rac.error().detail);
  if (!rac) return zhang;
  if (!zhang) return rac;
  if (zhang->rms_px < rac->rms_px) {
    zhang->singular_poses = rac->singular_poses;
    return zhang;
  }
  return rac;
}

}  // namespace enamel::calib
