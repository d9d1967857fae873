#include "calib/mount/mount_problem.hpp"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <memory>

#include "calib/mount/loose_stops.hpp"
#include "calib/solve/bundle.hpp"

namespace enamel::calib {
namespace {

constexpr double kPlayPrior_rad = 0.0087;  // 0.5 degrees where stops were reached from both sides
constexpr double kNoPlay_rad = 1e-9;
constexpr double kMinConditioning = 1e-12;  // of the scaled normal matrix

/// weight * x for every entry.
template <std::size_t N>
struct Prior {
  std::array<double, N> weight{};
  template <class T>
  bool operator()(const T* x, T* r) const {
    for (std::size_t i = 0; i < N; ++i) r[i] = weight[i] * x[i];
    return true;
  }
};

template <std::size_t N>
void add_prior(ceres::Problem& problem, const std::array<double, N>& weight, std::array<double, N>& block) {
  constexpr int kSize = static_cast<int>(N);
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior<N>, kSize, kSize>(new Prior<N>{weight}), nullptr,
                           block.data());
}

/// JtJ at the blocks' values, with the loss.
Eigen::MatrixXd normal_of(ceres::Problem& problem, const std::vector<double*>& blocks) {
  ceres::Problem::EvaluateOptions options;
  options.apply_loss_function = true;
  options.parameter_blocks = blocks;
  ceres::CRSMatrix jacobian;
  problem.Evaluate(options, nullptr, nullptr, nullptr, &jacobian);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(jacobian.num_cols, jacobian.num_cols);
  for (int row = 0; row < jacobian.num_rows; ++row) {
    const int begin = jacobian.rows[static_cast<std::size_t>(row)],
              end = jacobian.rows[static_cast<std::size_t>(row) + 1];
    for (int i = begin; i < end; ++i) {
      for (int k = begin; k < end; ++k) {
        normal(jacobian.cols[static_cast<std::size_t>(i)], jacobian.cols[static_cast<std::size_t>(k)]) +=
            jacobian.values[static_cast<std::size_t>(i)] * jacobian.values[static_cast<std::size_t>(k)];
      }
    }
  }
  return normal;
}

/// Columns of both lenses and T_proj_cam without either k3.
Eigen::MatrixXd without_k3(const Eigen::MatrixXd& all) {
  constexpr Eigen::Index kLens = 9, kFreeOfLens = 8, kMotion = 6;
  Eigen::MatrixXd out(all.rows(), kRigParameters);
  out << all.leftCols(kFreeOfLens), all.middleCols(kLens, kFreeOfLens), all.rightCols(kMotion);
  return out;
}

}  // namespace

std::vector<double*> MountBlocks::all() {
  std::vector<double*> out{rotation.data(), swing.data(), drive.data(), board.data()};
  for (StopBlock& stop : stops) out.push_back(stop.data());
  return out;
}

MountSetting setting_of(const std::vector<MountStop>& stops, const RigState& rig, const std::array<LineBase, 2>& base,
                        double dots) {
  MountSetting out;
  const LooseStops loose = loose_stops(stops);
  for (std::size_t j = 0; j < stops.size(); ++j)
    out.models.push_back({base[0], base[1], stops[j].angles, loose.rotation[j], loose.swing[j]});
  out.camera = block_of(rig.camera);
  out.projector = block_of(rig.projector);
  out.relative = block_of(rig.T_proj_cam);
  out.dots = dots;
  return out;
}

MountDotCost cost_of(const DotView& dot, const TargetDesign& target, const MountSetting& setting, std::size_t stop) {
  MountDotCost c;
  c.model = &setting.models[stop];
  c.camera = &setting.camera;
  c.projector = &setting.projector;
  c.relative = &setting.relative;
  c.place_mm = target.place(dot.dot);
  c.camera_px = dot.camera_px;
  c.whitening = Eigen::LLT<Eigen::Matrix2d>(Eigen::Matrix2d(setting.dots * dot.covariance_px2))
                    .matrixL()
                    .solve(Eigen::Matrix2d::Identity());
  c.map = dot.map;
  c.map.variance_px2 *= setting.dots;
  c.has_projector = !dot.samples.empty() && dot.map.variance_px2.minCoeff() > 0;
  return c;
}

void build_problem(const std::vector<MountStop>& stops, const TargetDesign& target, const StopPriors& priors,
                   const MountSetting& setting, ceres::Problem& problem, MountBlocks& b) {
  for (std::size_t j = 0; j < stops.size(); ++j) {
    for (const DotView& dot : stops[j].view.dots) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<MountDotCost, 4, 4, 4, 6, 6, 5>(
                                   new MountDotCost(cost_of(dot, target, setting, j))),
                               new ceres::HuberLoss(kDotHuber), b.rotation.data(), b.swing.data(), b.drive.data(),
                               b.board.data(), b.stops[j].data());
    }
  }
  const double angle[2] = {1 / priors.angle_rad[0], 1 / priors.angle_rad[1]}, shift = 1 / priors.shift_mm;
  for (StopBlock& stop : b.stops) add_prior<5>(problem, {angle[0], angle[1], shift, shift, shift}, stop);
  const LooseStops loose = loose_stops(stops);
  const double h = 1 / priors.harmonic_rad;
  add_prior<6>(problem,
               {h, h, h, h, 1 / (loose.is_rotation_seen ? kPlayPrior_rad : kNoPlay_rad),
                1 / (loose.is_swing_seen ? kPlayPrior_rad : kNoPlay_rad)},
               b.drive);
}

Eigen::MatrixXd inverse_normal(ceres::Problem& problem, MountBlocks& b) {
  const Eigen::MatrixXd normal = normal_of(problem, b.all());
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  if (!(solver.eigenvalues()[0] > kMinConditioning * solver.eigenvalues()[normal.rows() - 1])) return {};
  const Eigen::MatrixXd inverse =
      solver.eigenvectors() * solver.eigenvalues().cwiseInverse().asDiagonal() * solver.eigenvectors().transpose();
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

Eigen::MatrixXd rig_coupling(const std::vector<MountStop>& stops, const TargetDesign& target, MountSetting setting,
                             MountBlocks b) {
  ceres::Problem problem;
  for (std::size_t j = 0; j < stops.size(); ++j) {
    for (const DotView& dot : stops[j].view.dots) {
      const std::vector<double*> of_dot{b.rotation.data(),        b.swing.data(),         b.drive.data(),
                                        b.board.data(),           b.stops[j].data(),      setting.camera.data(),
                                        setting.projector.data(), setting.relative.data()};
      auto cost = std::make_unique<ceres::DynamicAutoDiffCostFunction<MountDotCost>>(
          new MountDotCost(cost_of(dot, target, setting, j)));
      for (const int size : {4, 4, 6, 6, 5, 9, 9, 6}) cost->AddParameterBlock(size);
      cost->SetNumResiduals(4);
      problem.AddResidualBlock(cost.release(), new ceres::HuberLoss(kDotHuber), of_dot);
    }
  }
  std::vector<double*> blocks = b.all();
  blocks.insert(blocks.end(), {setting.camera.data(), setting.projector.data(), setting.relative.data()});
  constexpr Eigen::Index kRigBlocks = 9 + 9 + 6;
  const Eigen::MatrixXd normal = normal_of(problem, blocks);
  return without_k3(normal.topRightCorner(normal.rows() - kRigBlocks, kRigBlocks));
}

}  // namespace enamel::calib
