#include "calib/solve/bundle.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <memory>

#include "calib/solve/plane_cost.hpp"
#include "calib/solve/projection.hpp"
#include "calib/solve/solver_options.hpp"

namespace enamel::calib {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kPlaneHuber = 3;  // of a ground sample's whitened distance
constexpr double kHuber = 4.5;     // of a dot's four whitened residuals together: 0.02 % of good dots lie beyond

/// A dot seen by both instruments. The projector's coordinate at the predicted camera place is that at the measured
/// one, moved by the local map.
struct DotCost {
  Vec3d design;
  Vector2d camera_px, projector_px;
  Matrix2d jacobian, camera_whitener;
  Vector2d projector_weight;

  template <class T>
  bool operator()(const T* camera, const T* projector, const T* relative, const T* motion, const T* offset,
                  T* residual) const {
    const auto p = move(motion, {design.x() + offset[0], design.y() + offset[1], design.z() + offset[2]});
    const auto c = image(camera, p);
    const auto q = image(projector, move(relative, p));
    const std::array<T, 2> d{T(camera_px.x()) - c[0], T(camera_px.y()) - c[1]};
    residual[0] = camera_whitener(0, 0) * d[0] + camera_whitener(0, 1) * d[1];
    residual[1] = camera_whitener(1, 0) * d[0] + camera_whitener(1, 1) * d[1];
    for (int k = 0; k < 2; ++k) {
      residual[2 + k] = projector_weight[k] * (projector_px[k] - jacobian(k, 0) * d[0] - jacobian(k, 1) * d[1] -
                                               q[static_cast<std::size_t>(k)]);
    }
    return true;
  }
};

struct OffsetPrior {
  Vec3d weight;

  template <class T>
  bool operator()(const T* offset, T* residual) const {
    for (int k = 0; k < 3; ++k) residual[k] = weight[k] * offset[k];
    return true;
  }
};

struct Blocks {
  LensBlock camera, projector;
  MotionBlock relative;
  std::vector<MotionBlock> motions;
  std::vector<std::array<double, 3>> offsets;
};

Blocks blocks_of(const RigState& s) {
  Blocks b{block_of(s.camera), block_of(s.projector), block_of(s.T_proj_cam), {}, {}};
  for (const Pose& p : s.T_cam_target) b.motions.push_back(block_of(p));
  for (const Vec3d& o : s.dot_offsets_mm) b.offsets.push_back({o.x(), o.y(), o.z()});
  return b;
}

void store(const Blocks& b, RigState& s) {
  set_lens(s.camera, b.camera);
  set_lens(s.projector, b.projector);
  s.T_proj_cam = pose_of(b.relative);
  for (std::size_t j = 0; j < b.motions.size(); ++j) s.T_cam_target[j] = pose_of(b.motions[j]);
  for (std::size_t i = 0; i < b.offsets.size(); ++i)
    s.dot_offsets_mm[i] = {b.offsets[i][0], b.offsets[i][1], b.offsets[i][2]};
}

DotCost cost_of(const DotView& dot, const TargetDesign& target, const VarianceFactors& variance) {
  const Matrix2d information =
      (dot.covariance_px2 * variance.camera + variance.camera_floor_px2 * Matrix2d::Identity()).inverse();
  return {target.place(dot.dot),
          dot.camera_px,
          dot.map.projector_px,
          dot.map.jacobian,
          Eigen::LLT<Matrix2d>(information).matrixU(),
          (dot.map.variance_px2 * variance.projector).cwiseSqrt().cwiseInverse()};
}

DotResidual residual_of(const DotView& dot, const DotCost& cost, const Blocks& b, std::size_t pose) {
  const auto& offset = b.offsets[static_cast<std::size_t>(dot.dot)];
  double r[4];
  cost(b.camera.data(), b.projector.data(), b.relative.data(), b.motions[pose].data(), offset.data(), r);
  DotResidual out;
  out.pose = pose;
  out.camera_chi2 = r[0] * r[0] + r[1] * r[1];
  out.projector_chi2 = r[2] * r[2] + r[3] * r[3];
  out.camera_px = cost.camera_whitener.inverse() * Vector2d(r[0], r[1]);
  out.projector_px =
      Vector2d(r[2] / cost.projector_weight[0], r[3] / cost.projector_weight[1]) + cost.jacobian * out.camera_px;
  return out;
}

BundleResult summarise(const std::vector<PoseView>& poses, const TargetDesign& target, const BundleOptions& options,
                       const Blocks& blocks) {
  BundleResult result;
  double camera = 0, projector = 0;
  for (std::size_t j = 0; j < poses.size(); ++j) {
    for (std::size_t i = 0; i < poses[j].dots.size(); ++i) {
      const DotView& dot = poses[j].dots[i];
      DotResidual r = residual_of(dot, cost_of(dot, target, options.variance), blocks, j);
      r.view = i;
      result.residuals.push_back(r);
      if (dot.is_outlier) continue;
      result.chi2 += r.camera_chi2 + r.projector_chi2;
      result.observations += 4;
      camera += r.camera_px.squaredNorm();
      projector += r.projector_px.squaredNorm();
    }
  }
  const double dots = 0.25 * result.observations;
  result.rms_camera_px = std::sqrt(camera / dots);
  result.rms_projector_px = std::sqrt(projector / dots);
  result.parameters = kRigParameters + 6 * static_cast<int>(poses.size());
  // Seven of the offsets' freedoms, a similarity, lie with the poses and the prior.
  if (options.solve_shape) result.parameters += 3 * target.size() - 7;
  return result;
}

void build(const std::vector<PoseView>& poses, const TargetDesign& target, const BundleOptions& options,
           ceres::Problem& problem, Blocks& b) {
  std::vector<bool> seen(b.offsets.size(), false);
  for (std::size_t j = 0; j < poses.size(); ++j) {
    for (const DotView& dot : poses[j].dots) {
      if (dot.is_outlier) continue;
      const auto d = static_cast<std::size_t>(dot.dot);
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<DotCost, 4, 9, 9, 6, 6, 3>(
                                   new DotCost(cost_of(dot, target, options.variance))),
                               new ceres::HuberLoss(kHuber), b.camera.data(), b.projector.data(), b.relative.data(),
                               b.motions[j].data(), b.offsets[d].data());
      seen[d] = true;
    }
  }
  const Vec3d weight(1 / options.shape.in_plane_mm, 1 / options.shape.in_plane_mm, 1 / options.shape.out_of_plane_mm);
  for (std::size_t d = 0; d < b.offsets.size(); ++d) {
    if (!seen[d]) continue;
    if (options.solve_shape) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OffsetPrior, 3, 3>(new OffsetPrior{weight}), nullptr,
                               b.offsets[d].data());
    } else {
      problem.SetParameterBlockConstant(b.offsets[d].data());
    }
  }
  problem.SetManifold(b.camera.data(), new ceres::SubsetManifold(9, {8}));
  problem.SetManifold(b.projector.data(), new ceres::SubsetManifold(9, {8}));
}

/// Means over the grid's cells at the state at hand: few terms that say next to all the samples do.
void add_planes(const std::vector<PoseView>& poses, const TargetDesign& target, const BundleOptions& options,
                const RigState& state, ceres::Problem& problem, Blocks& b) {
  for (std::size_t j = 0; j < poses.size(); ++j) {
    for (const GroundSample& s : condensed(poses[j].ground, target, state, state.T_cam_target[j])) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PlaneCost, 1, 9, 9, 6, 6>(new PlaneCost(
                                   plane_cost(s, target, state, state.T_cam_target[j], options.variance.ground))),
                               new ceres::HuberLoss(kPlaneHuber), b.camera.data(), b.projector.data(),
                               b.relative.data(), b.motions[j].data());
    }
  }
}

/// Covariance of the rig's parameters; empty when the problem leaves some of them open.
Eigen::MatrixXd rig_covariance(ceres::Problem& problem, const Blocks& b) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.apply_loss_function = false;
  ceres::Covariance covariance(options);
  const std::vector<const double*> rig{b.camera.data(), b.projector.data(), b.relative.data()};
  if (!covariance.Compute(rig, &problem)) return {};
  Eigen::Matrix<double, 24, 24, Eigen::RowMajor> full;
  if (!covariance.GetCovarianceMatrix(rig, full.data())) return {};
  // Both lenses without their k3 (places 8 and 17), then the relative pose.
  constexpr std::array<Eigen::Index, kRigParameters> kKeep{0,  1,  2,  3,  4,  5,  6,  7,  9,  10, 11,
                                                           12, 13, 14, 15, 16, 18, 19, 20, 21, 22, 23};
  Eigen::MatrixXd out(kRigParameters, kRigParameters);
  for (Eigen::Index r = 0; r < kRigParameters; ++r) {
    for (Eigen::Index c = 0; c < kRigParameters; ++c)
      out(r, c) = full(kKeep[static_cast<std::size_t>(r)], kKeep[static_cast<std::size_t>(c)]);
  }
  return out;
}

}  // namespace

std::array<const char*, kRigParameters> rig_parameter_names() {
  return {"camera.fx",     "camera.fy",     "camera.cx",     "camera.cy",    "camera.k1",     "camera.k2",
          "camera.p1",     "camera.p2",     "projector.fx",  "projector.fy", "projector.cx",  "projector.cy",
          "projector.k1",  "projector.k2",  "projector.p1",  "projector.p2", "T_proj_cam.rx", "T_proj_cam.ry",
          "T_proj_cam.rz", "T_proj_cam.tx", "T_proj_cam.ty", "T_proj_cam.tz"};
}

BundleResult bundle(const std::vector<PoseView>& poses, const TargetDesign& target, const BundleOptions& options,
                    RigState& state) {
  Blocks blocks = blocks_of(state);
  ceres::Problem problem;
  build(poses, target, options, problem, blocks);
  if (options.with_planes) add_planes(poses, target, options, state, problem, blocks);
  const ceres::Solver::Options solver =
      adjustment_options(options.solve_shape ? ceres::SPARSE_NORMAL_CHOLESKY : ceres::DENSE_NORMAL_CHOLESKY);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  store(blocks, state);
  BundleResult result = summarise(poses, target, options, blocks);
  if (options.with_covariance) result.covariance = rig_covariance(problem, blocks);
  return result;
}

std::vector<double> plane_chi2(const std::vector<PoseView>& poses, const TargetDesign& target, const RigState& state,
                               double variance_factor) {
  const Blocks b = blocks_of(state);
  std::vector<double> out;
  for (std::size_t j = 0; j < poses.size(); ++j) {
    for (const GroundSample& s : condensed(poses[j].ground, target, state, state.T_cam_target[j])) {
      double r = 0;
      plane_cost(s, target, state, state.T_cam_target[j], variance_factor)(b.camera.data(), b.projector.data(),
                                                                           b.relative.data(), b.motions[j].data(), &r);
      out.push_back(r * r);
    }
  }
  return out;
}

BundleResult evaluate(const std::vector<PoseView>& poses, const TargetDesign& target, const BundleOptions& options,
                      const RigState& state) {
  return summarise(poses, target, options, blocks_of(state));
}

}  // namespace enamel::calib
