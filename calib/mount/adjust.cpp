#include "calib/mount/adjust.hpp"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/solve/solver_options.hpp"
#include "pipeline/types/pose_rows.hpp"

namespace enamel::calib {
namespace {

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

/// As the loss has it: one wild dot is no measure of all the others.
double huber(double norm) { return norm < kDotHuber ? norm * norm : kDotHuber * (2 * norm - kDotHuber); }

/// Residuals stop by stop and the misfit of all dots.
void summarise(const std::vector<MountStop>& stops, const TargetDesign& target, const MountSetting& setting,
               const MountBlocks& b, Adjusted& out) {
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
  const MountSetting setting = setting_of(stops, rig, out.base, priors.dots);
  MountBlocks& b = out.blocks;
  const auto &hr = start.rotation.harmonic_rad, &hs = start.swing.harmonic_rad;
  b.drive = {hr[0], hr[1], hs[0], hs[1], start.rotation.backlash_rad, start.swing.backlash_rad};
  b.board = block_of(start.T_camera_board);
  b.stops = start.stops;
  ceres::Problem problem;
  build_problem(stops, target, priors, setting, problem, b);
  const ceres::Solver::Options solver = adjustment_options(ceres::DENSE_NORMAL_CHOLESKY);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  out.covariance = inverse_normal(problem, b);
  out.is_determined = out.covariance.size() > 0;
  summarise(stops, target, setting, b, out);
  out.state.rotation = line_of(out.base[0], b.rotation, b.drive.data(), b.drive[4]);
  out.state.swing = line_of(out.base[1], b.swing, b.drive.data() + 2, b.drive[5]);
  out.state.T_camera_board = pose_of(b.board);
  out.state.stops = b.stops;
  return out;
}

Eigen::MatrixXd rig_share(const std::vector<MountStop>& stops, const TargetDesign& target, const RigState& rig,
                          const StopPriors& priors, const Adjusted& a, const Eigen::MatrixXd& rig_covariance) {
  const MountSetting setting = setting_of(stops, rig, a.base, priors.dots);
  const Eigen::MatrixXd gain = -a.covariance * rig_coupling(stops, target, setting, a.blocks);
  return gain * rig_covariance * gain.transpose();
}

}  // namespace enamel::calib
