#include "calib/mount/adjust.hpp"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/solve/solver_options.hpp"
#include "pipeline/types/pose_rows.hpp"

namespace enamel::calib {
namespace {

constexpr double kHuber = 4.5;             // of a dot's four whitened residuals
constexpr double kPlayPrior_rad = 0.0087;  // 0.5 degrees where stops were reached from both sides
constexpr double kNoPlay_rad = 1e-9;
constexpr double kMinConditioning = 1e-12;  // of the scaled normal matrix
constexpr int kSideStops = 3;

struct Blocks {
  LineBlock rotation{}, swing{};
  DriveBlock drive{};
  MotionBlock board{};
  std::vector<StopBlock> stops;
};

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

LineBase base_of(const AxisLine& line, const Vec3d& about) {
  LineBase base;
  base.d0 = Vec3d(line.direction.data());
  const Vec3d p(line.point_mm.data());
  base.p0 = p + base.d0 * base.d0.dot(about - p);
  base.e1 = base.d0.unitOrthogonal();
  base.e2 = base.d0.cross(base.e1);
  return base;
}

AxisLine line_of(const LineBase& base, const LineBlock& b, const double* harmonic, double play) {
  AxisLine line;
  line.direction = base.direction(b.data());
  line.point_mm = base.point(b.data());
  line.harmonic_rad = {harmonic[0], harmonic[1]};
  line.backlash_rad = play;
  return line;
}

/// Everything that the residuals point into while a problem lives.
struct Setting {
  std::vector<StopModel> models;
  LensBlock camera{}, projector{};
  MotionBlock relative{};
  double dots = 1;  ///< factor of their variances
};

Setting setting_of(const std::vector<MountStop>& stops, const RigState& rig, const LineBase& r, const LineBase& s) {
  Setting out;
  const LooseStops loose = loose_stops(stops);
  for (std::size_t j = 0; j < stops.size(); ++j)
    out.models.push_back({r, s, stops[j].angles, loose.rotation[j], loose.swing[j]});
  out.camera = block_of(rig.camera);
  out.projector = block_of(rig.projector);
  out.relative = block_of(rig.T_proj_cam);
  return out;
}

MountDotCost cost_of(const DotView& dot, const TargetDesign& target, const Setting& setting, std::size_t stop) {
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

void build(const std::vector<MountStop>& stops, const TargetDesign& target, const StopPriors& priors,
           const Setting& setting, ceres::Problem& problem, Blocks& b) {
  for (std::size_t j = 0; j < stops.size(); ++j) {
    for (const DotView& dot : stops[j].view.dots) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<MountDotCost, 4, 4, 4, 6, 6, 5>(
                                   new MountDotCost(cost_of(dot, target, setting, j))),
                               new ceres::HuberLoss(kHuber), b.rotation.data(), b.swing.data(), b.drive.data(),
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

/// Inverse of the normal matrix at the solution, all blocks in order; `is_determined` false where it has no inverse.
Eigen::MatrixXd covariance_of(ceres::Problem& problem, Blocks& b, bool& is_determined) {
  ceres::Problem::EvaluateOptions options;
  options.apply_loss_function = true;
  options.parameter_blocks = {b.rotation.data(), b.swing.data(), b.drive.data(), b.board.data()};
  for (StopBlock& stop : b.stops) options.parameter_blocks.push_back(stop.data());
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
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  is_determined = solver.eigenvalues()[0] > kMinConditioning * solver.eigenvalues()[normal.rows() - 1];
  if (!is_determined) return {};
  const Eigen::MatrixXd inverse =
      solver.eigenvectors() * solver.eigenvalues().cwiseInverse().asDiagonal() * solver.eigenvectors().transpose();
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

/// As the loss has it: one wild dot is no measure of all the others.
double huber(double norm) { return norm < kHuber ? norm * norm : kHuber * (2 * norm - kHuber); }

/// Residuals stop by stop and the misfit of all dots.
void summarise(const std::vector<MountStop>& stops, const TargetDesign& target, const Setting& setting, const Blocks& b,
               Adjusted& out) {
  double chi2 = 0;
  int n = 0;
  for (std::size_t j = 0; j < stops.size(); ++j) {
    const StopBlock& own = b.stops[j];
    StopResult r{.pose = stops[j].view.name,
                 .rotation_rad = own[0],
                 .swing_rad = own[1],
                 .shift_mm = Vec3d(own[2], own[3], own[4]),
                 .dots = stops[j].view.dots.size()};
    double camera = 0, projector = 0;
    for (const DotView& dot : stops[j].view.dots) {
      const MountDotCost cost = cost_of(dot, target, setting, j);
      Eigen::Vector4d e = Eigen::Vector4d::Zero();
      if (!cost(b.rotation.data(), b.swing.data(), b.drive.data(), b.board.data(), own.data(), e.data())) continue;
      const Eigen::Vector2d px = cost.whitening.inverse() * e.head<2>();
      camera += px.squaredNorm();
      if (cost.has_projector) projector += e.tail<2>().cwiseAbs2().dot(cost.map.variance_px2);
      chi2 += huber(e.norm());
      n += cost.has_projector ? 4 : 2;
    }
    const double dots = static_cast<double>(std::max<std::size_t>(1, r.dots));
    r.rms_camera_px = std::sqrt(camera / dots);
    r.rms_projector_px = std::sqrt(projector / dots);
    out.results.push_back(std::move(r));
  }
  const int freedom = n - kMountBlock - 5 * static_cast<int>(stops.size());
  out.misfit = freedom > 0 ? chi2 / freedom : 0;
}

}  // namespace

LooseStops loose_stops(const std::vector<MountStop>& stops) {
  LooseStops out{std::vector<bool>(stops.size(), false), std::vector<bool>(stops.size(), false), false, false};
  const auto walk = [&](auto command, auto read, std::vector<bool>& loose, bool& is_seen) {
    constexpr double kStill_rad = 1e-6;
    int rising = 0, falling = 0;
    for (std::size_t j = 1; j < stops.size(); ++j) {
      const double step = stops[j].angles.*command - stops[j - 1].angles.*command;
      const bool has_play = std::isnan(stops[j].angles.*read);
      loose[j] = has_play && (step < -kStill_rad || (std::abs(step) <= kStill_rad && loose[j - 1]));
      (loose[j] ? falling : rising) += has_play ? 1 : 0;
    }
    is_seen = rising >= kSideStops && falling >= kSideStops;
    if (!is_seen) loose.assign(stops.size(), false);
  };
  walk(&AxisAngles::rotation_command, &AxisAngles::rotation_read, out.rotation, out.is_rotation_seen);
  walk(&AxisAngles::swing_command, &AxisAngles::swing_read, out.swing, out.is_swing_seen);
  return out;
}

Pose board_at(const MountState& state, const AxisAngles& angles, const StopBlock& stop) {
  Mount mount;
  mount.rotation = state.rotation;
  mount.swing = state.swing;
  const Pose motion =
      pose_of_rows(table_motion(mount, angles, {.pose = {}, .rotation_rad = stop[0], .swing_rad = stop[1]}));
  Pose pose = motion * state.T_camera_board;
  pose.translation() += Vec3d(stop[2], stop[3], stop[4]);
  return pose;
}

Vec3d seen_middle(const std::vector<MountStop>& stops, const TargetDesign& target, const MountState& state) {
  Vec3d sum = Vec3d::Zero();
  double n = 0;
  for (std::size_t j = 0; j < stops.size(); ++j) {
    const Pose pose = board_at(state, stops[j].angles, state.stops[j]);
    for (const DotView& dot : stops[j].view.dots) {
      sum += pose * target.place(dot.dot);
      n += 1;
    }
  }
  return n > 0 ? Vec3d(sum / n) : sum;
}

Adjusted adjust(const std::vector<MountStop>& stops, const TargetDesign& target, const RigState& rig,
                const StopPriors& priors, const MountState& start) {
  Adjusted out;
  const Vec3d about = seen_middle(stops, target, start);
  out.base = {base_of(start.rotation, about), base_of(start.swing, about)};
  Setting setting = setting_of(stops, rig, out.base[0], out.base[1]);
  setting.dots = priors.dots;
  Blocks b;
  const auto &hr = start.rotation.harmonic_rad, &hs = start.swing.harmonic_rad;
  b.drive = {hr[0], hr[1], hs[0], hs[1], start.rotation.backlash_rad, start.swing.backlash_rad};
  b.board = block_of(start.T_camera_board);
  b.stops = start.stops;
  ceres::Problem problem;
  build(stops, target, priors, setting, problem, b);
  const ceres::Solver::Options solver = adjustment_options(ceres::DENSE_NORMAL_CHOLESKY);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  out.covariance = covariance_of(problem, b, out.is_determined);
  summarise(stops, target, setting, b, out);
  out.state.rotation = line_of(out.base[0], b.rotation, b.drive.data(), b.drive[4]);
  out.state.swing = line_of(out.base[1], b.swing, b.drive.data() + 2, b.drive[5]);
  out.state.T_camera_board = pose_of(b.board);
  out.state.stops = b.stops;
  return out;
}

}  // namespace enamel::calib
