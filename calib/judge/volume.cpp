#include "calib/judge/volume.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/judge/volume_grid.hpp"
#include "calib/solve/triangulate.hpp"

namespace enamel::calib {
namespace {

constexpr int kDepths = 9, kRows = 13, kCols = 17;

/// Rigid motion that lays `from` on `to`; `scale` that a similarity would have.
Pose rigid(const VolumePairs& pairs, double& scale) {
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
  VolumePairs pairs;
  add_depth(solved, reference, z_mm, pairs);
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t i = 0; i < pairs.solved.size(); ++i) {
    if (pairs.reference[i].head<2>().cwiseAbs().maxCoeff() > kHalfFacing_mm) continue;
    const Vec3d p = motion * pairs.solved[i];
    const Eigen::Matrix<double, 6, 1> j = plane_terms(p);
    h += j * j.transpose();
    b += j * (p.z() - pairs.reference[i].z()) * 1e3;
  }
  const Eigen::Matrix<double, 6, 1> x = h.ldlt().solve(b);
  return {x[3], x[5], x[4]};
}

}  // namespace

void add_depth(const RigState& solved, const RigState& reference, double z_mm, VolumePairs& pairs) {
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

VolumePairs volume_pairs(const RigState& solved, const RigState& reference, DepthRange range) {
  VolumePairs pairs;
  const double deep = range.far_mm - range.near_mm;
  for (int k = 0; k < kDepths; ++k) add_depth(solved, reference, range.near_mm + deep * k / (kDepths - 1), pairs);
  return pairs;
}

std::array<double, 3> plane_depths_mm(DepthRange range) {
  const double deep = range.far_mm - range.near_mm;
  return {range.near_mm + deep / 8, range.near_mm + deep / 2, range.near_mm + 7 * deep / 8};
}

VolumeDifference compare_rigs(const RigState& solved, const RigState& reference, DepthRange range) {
  const VolumePairs pairs = volume_pairs(solved, reference, range);
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
  out.depth_mm = plane_depths_mm(range);
  for (std::size_t k = 0; k < 3; ++k) out.planes[k] = plane_shape(solved, reference, motion, out.depth_mm[k]);
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
