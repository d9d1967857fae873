#include "calib/judge/volume.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/solve/triangulate.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::calib {
namespace {

constexpr int kDepths = 9, kRows = 13, kCols = 17;
constexpr double kHalfPlane_mm = 8;

struct Pairs {
  std::vector<Vec3d> solved, reference;
};

/// Points of the reference around depth z (its correction moves them off by microns), and where the solved rig puts
/// them.
void add_depth(const RigState& solved, const RigState& reference, double z_mm, Pairs& pairs) {
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kCols; ++c) {
      const double u = c * (reference.camera.width - 1.0) / (kCols - 1);
      const double v = r * (reference.camera.height - 1.0) / (kRows - 1);
      const Vec3d ray = camera_ray(reference.camera, u, v);
      const double up = projector_u(reference, ray * z_mm);
      if (!(up > -0.5 && up < reference.projector.width - 0.5)) continue;
      const double q = 1 / z_mm;
      pairs.reference.push_back(reference.correction ? Vec3d(ray / (q + correction_at(*reference.correction, u, v, q)))
                                                     : Vec3d(ray * z_mm));
      pairs.solved.push_back(triangulate(solved, camera_ray(solved.camera, u, v), up, z_mm));
    }
  }
}

/// Rigid motion that lays `from` on `to`; `scale` that a similarity would have.
Pose rigid(const Pairs& pairs, double& scale) {
  const double n = static_cast<double>(pairs.solved.size());
  Vec3d from = Vec3d::Zero(), to = Vec3d::Zero();
  for (std::size_t i = 0; i < pairs.solved.size(); ++i) {
    from += pairs.solved[i] / n;
    to += pairs.reference[i] / n;
  }
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < pairs.solved.size(); ++i) {
    cross += (pairs.solved[i] - from) * (pairs.reference[i] - to).transpose();
    spread += (pairs.solved[i] - from).squaredNorm();
  }
  // Horn 1987: the rotation's quaternion is the largest eigenvector of a matrix made of the cross-covariance.
  const Vec3d d(cross(1, 2) - cross(2, 1), cross(2, 0) - cross(0, 2), cross(0, 1) - cross(1, 0));
  Eigen::Matrix4d horn;
  horn << cross.trace(), d.transpose(), d, cross + cross.transpose() - cross.trace() * Eigen::Matrix3d::Identity();
  const Eigen::Vector4d q = Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(horn).eigenvectors().col(3);
  Pose motion = Pose::Identity();
  motion.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  scale = (motion.linear() * cross).trace() / spread;
  motion.translation() = to - motion.linear() * from;
  return motion;
}

PlaneShape plane_shape(const RigState& solved, const RigState& reference, const Pose& motion, double z_mm) {
  Pairs pairs;
  add_depth(solved, reference, z_mm, pairs);
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t i = 0; i < pairs.solved.size(); ++i) {
    if (pairs.reference[i].head<2>().cwiseAbs().maxCoeff() > kHalfPlane_mm) continue;
    const Vec3d p = motion * pairs.solved[i];
    const double x = p.x() / kHalfPlane_mm, y = p.y() / kHalfPlane_mm;
    const Eigen::Matrix<double, 6, 1> j = (Eigen::Matrix<double, 6, 1>() << 1, x, y, x * x, x * y, y * y).finished();
    h += j * j.transpose();
    b += j * (p.z() - pairs.reference[i].z()) * 1e3;
  }
  const Eigen::Matrix<double, 6, 1> x = h.ldlt().solve(b);
  return {x[3], x[5], x[4]};
}

/// Nearest-rank quantile of the magnitudes.
double quantile_of(std::vector<double> values, double quantile) {
  for (double& v : values) v = std::abs(v);
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(quantile * static_cast<double>(values.size() - 1)))];
}

RigState moved(RigState s, const Eigen::VectorXd& d) {
  const auto move_lens = [&](LensValues& l, Eigen::Index at) {
    l.fx += d[at];
    l.fy += d[at + 1];
    l.cx += d[at + 2];
    l.cy += d[at + 3];
    for (std::size_t i = 0; i < 4; ++i) l.dist[i] += d[at + 4 + static_cast<Eigen::Index>(i)];
  };
  move_lens(s.camera, 0);
  move_lens(s.projector, 8);
  const Eigen::AngleAxisd r(s.T_proj_cam.linear());
  const Vec3d w = r.angle() * r.axis() + Vec3d(d.segment<3>(16));
  s.T_proj_cam.linear() = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
  s.T_proj_cam.translation() += d.segment<3>(19);
  return s;
}

}  // namespace

VolumeDifference compare_rigs(const RigState& solved, const RigState& reference, DepthRange range) {
  Pairs pairs;
  const double deep = range.far_mm - range.near_mm;
  for (int k = 0; k < kDepths; ++k) add_depth(solved, reference, range.near_mm + deep * k / (kDepths - 1), pairs);
  VolumeDifference out;
  if (pairs.solved.empty()) return out;
  double scale = 1;
  const Pose motion = rigid(pairs, scale);
  out.scale_ppm = 1e6 * (scale - 1);
  std::vector<double> off, shape;
  off.reserve(pairs.solved.size());
  shape.reserve(pairs.solved.size());
  double squares = 0;
  Vec3d middle_mm = Vec3d::Zero();
  for (const Vec3d& p : pairs.reference) middle_mm += p / static_cast<double>(pairs.reference.size());
  for (std::size_t i = 0; i < pairs.solved.size(); ++i) {
    const Vec3d p = motion * pairs.solved[i];
    off.push_back(1e3 * (p - pairs.reference[i]).norm());
    shape.push_back(1e3 * (middle_mm + scale * (p - middle_mm) - pairs.reference[i]).norm());
    squares += off.back() * off.back();
  }
  std::sort(off.begin(), off.end());
  std::sort(shape.begin(), shape.end());
  out.shape_p95_um = shape[shape.size() * 95 / 100];
  out.rms_um = std::sqrt(squares / static_cast<double>(off.size()));
  out.p95_um = off[off.size() * 95 / 100];
  out.max_um = off.back();
  for (std::size_t k = 0; k < 3; ++k) {
    out.depth_mm[k] = range.near_mm + deep * (1 + 3 * static_cast<double>(k)) / 8;
    out.planes[k] = plane_shape(solved, reference, motion, out.depth_mm[k]);
  }
  return out;
}

VolumeDifference predict_difference(const RigState& state, const Eigen::MatrixXd& covariance, DepthRange range,
                                    double quantile, int draws) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  const Eigen::MatrixXd root = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  Rng rng(1, 0, 1);
  std::vector<VolumeDifference> all;
  all.reserve(static_cast<std::size_t>(draws));
  for (int k = 0; k < draws; ++k) {
    Eigen::VectorXd z(covariance.rows());
    for (double& value : z) value = rng.normal();
    all.push_back(compare_rigs(moved(state, root * z), state, range));
  }
  const auto middle_of = [&](auto value) {
    std::vector<double> values;
    values.reserve(all.size());
    for (const auto& d : all) values.push_back(value(d));
    return quantile_of(std::move(values), quantile);
  };
  VolumeDifference out = all.front();
  out.p95_um = middle_of([](const auto& d) { return d.p95_um; });
  out.shape_p95_um = middle_of([](const auto& d) { return d.shape_p95_um; });
  out.rms_um = middle_of([](const auto& d) { return d.rms_um; });
  out.max_um = middle_of([](const auto& d) { return d.max_um; });
  out.scale_ppm = middle_of([](const auto& d) { return d.scale_ppm; });
  for (std::size_t k = 0; k < 3; ++k) {
    out.planes[k].sag_x_um = middle_of([k](const auto& d) { return d.planes[k].sag_x_um; });
    out.planes[k].sag_y_um = middle_of([k](const auto& d) { return d.planes[k].sag_y_um; });
    out.planes[k].twist_um = middle_of([k](const auto& d) { return d.planes[k].twist_um; });
  }
  return out;
}

RigState state_of(const Rig& rig) {
  RigState s;
  s.camera = rig.camera;
  s.projector = rig.projector;
  s.correction = rig.correction;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c)
      s.T_proj_cam.matrix()(r, c) = rig.T_proj_cam[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  }
  return s;
}

}  // namespace enamel::calib
