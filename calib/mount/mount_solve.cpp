#include "calib/mount/mount_solve.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/mount/adjust.hpp"
#include "calib/mount/loose_stops.hpp"
#include "calib/mount/mount_checks.hpp"
#include "calib/solve/disc_centres.hpp"

namespace enamel::calib {
namespace {

constexpr int kRounds = 4;  // of variance components: each takes what is left to a tenth
constexpr double kLeastAngle_rad = 1e-4 * kRadPerDegree, kLeastShift_mm = 1e-4;
constexpr double kMostShift_mm = 0.02;
constexpr double kPlaySigmas = 3;  // a play below is none

std::vector<Pose> poses_of(const std::vector<MountStop>& stops, const MountState& state) {
  std::vector<Pose> out;
  for (std::size_t j = 0; j < stops.size(); ++j) out.push_back(board_at(state, stops[j].angles, state.stops[j]));
  return out;
}

/// Centres of discs and projector coordinates at them, by the poses at hand.
void refine(std::vector<MountStop>& stops, const TargetDesign& target, RigState rig, std::vector<Pose> poses) {
  std::vector<PoseView> views;
  for (MountStop& stop : stops) views.push_back(std::move(stop.view));
  rig.T_cam_target = std::move(poses);
  rig.dot_offsets_mm.assign(static_cast<std::size_t>(target.size()), Vec3d::Zero());
  refine_centres(views, target, rig);
  for (std::size_t j = 0; j < stops.size(); ++j) stops[j].view = std::move(views[j]);
}

Result<MountState> start_state(std::vector<MountStop>& stops, const TargetDesign& target, const RigState& rig) {
  std::vector<AxisAngles> angles;
  for (const MountStop& stop : stops) angles.push_back(stop.angles);
  std::vector<Pose> poses;
  for (int round = 0; round < 2; ++round) {
    poses.clear();
    for (const MountStop& stop : stops) {
      ENAMEL_TRY_ASSIGN(const Pose pose, board_pose(stop.view, target, rig.camera));
      poses.push_back(pose);
    }
    refine(stops, target, rig, poses);
  }
  ENAMEL_TRY_ASSIGN(const AxisStart start, start_axes(poses, angles));
  return MountState{start.rotation, start.swing, start.T_camera_board, std::vector<StopBlock>(stops.size())};
}

/// Variance component of a group of corrections: sum of squares over their redundancy, 1 - posterior / prior variance
/// each (Foerstner 1979).
double component(const Adjusted& a, double prior, int first, int count) {
  double squares = 0, redundancy = 0;
  for (std::size_t j = 0; j < a.state.stops.size(); ++j) {
    for (int k = first; k < first + count; ++k) {
      const Eigen::Index at = kMountBlock + 5 * static_cast<Eigen::Index>(j) + k;
      squares += std::pow(a.state.stops[j][static_cast<std::size_t>(k)], 2);
      redundancy += std::max(0.0, 1 - a.covariance(at, at) / (prior * prior));
    }
  }
  return redundancy > 1 ? std::sqrt(squares / redundancy) : prior;
}

struct Round {
  Adjusted adjusted;
  StopPriors priors;
};

/// Adjusts with the stated priors first, so that a wrong stop cannot widen them, then with estimated ones.
Result<Round> settle(std::vector<MountStop>& stops, const TargetDesign& target, const RigState& rig,
                     const MountOptions& options, MountState state, bool with_components) {
  StopPriors priors{
      {options.stop_prior_rad, options.stop_prior_rad}, options.wobble_prior_mm, options.harmonic_prior_rad};
  Adjusted a = adjust(stops, target, rig, priors, state);
  for (int round = 0; round < (with_components ? kRounds : 1); ++round) {
    if (!a.is_determined) {
      return fail(ErrorCode::kCalibrationPoses,
                  "the pictures leave the axes open: spread the stops wider over both angles");
    }
    if (with_components) {
      for (int k = 0; k < 2; ++k) {
        double& prior = priors.angle_rad[static_cast<std::size_t>(k)];
        prior = std::clamp(component(a, prior, k, 1), kLeastAngle_rad, options.stop_prior_rad);
      }
      priors.dots = std::max(1.0, priors.dots * a.misfit);
      priors.shift_mm = std::clamp(component(a, priors.shift_mm, 2, 3), kLeastShift_mm, kMostShift_mm);
    }
    refine(stops, target, rig, poses_of(stops, a.state));
    a = adjust(stops, target, rig, priors, a.state);
  }
  if (!a.is_determined) return fail(ErrorCode::kCalibrationPoses, "the pictures leave the axes open");
  return Round{std::move(a), priors};
}

LineSigma sigma_of(const Adjusted& a, Eigen::Index first) {
  const auto larger = [&](Eigen::Index at) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(
        Eigen::Matrix2d(a.covariance.block<2, 2>(first + at, first + at)));
    return std::sqrt(std::max(0.0, solver.eigenvalues()[1]));
  };
  return {larger(0), larger(2)};
}

/// Rows of the file's numbers over the eight of a line and its harmonics: the direction moves by a e1 + b e2, the point
/// nearest to the origin, p - d (d·p), by what follows from that.
Eigen::Matrix<double, 8, 6> file_jacobian(const LineBase& base) {
  Eigen::Matrix<double, 8, 6> j = Eigen::Matrix<double, 8, 6>::Zero();
  const Vec3d axes[2] = {base.e1, base.e2};
  for (int k = 0; k < 2; ++k) {
    j.block<3, 1>(0, k) = axes[k];
    j.block<3, 1>(3, k) = -axes[k] * base.d0.dot(base.p0) - base.d0 * axes[k].dot(base.p0);
    j.block<3, 1>(3, 2 + k) = axes[k];
    j(6 + k, 4 + k) = 1;
  }
  return j;
}

MountCovariance file_covariance(const Adjusted& a) {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(16, kMountBlock);
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const Eigen::Matrix<double, 8, 6> own = file_jacobian(a.base[static_cast<std::size_t>(axis)]);
    jacobian.block<8, 4>(8 * axis, 4 * axis) = own.leftCols<4>();
    jacobian.block<8, 2>(8 * axis, 8 + 2 * axis) = own.rightCols<2>();
  }
  const Eigen::MatrixXd c = jacobian * a.covariance.topLeftCorner(kMountBlock, kMountBlock) * jacobian.transpose();
  MountCovariance out;
  const auto names = mount_parameter_names();
  out.parameters.assign(names.begin(), names.end());
  for (Eigen::Index r = 0; r < c.rows(); ++r)
    for (Eigen::Index k = 0; k < c.cols(); ++k) out.matrix.push_back(r == k ? std::max(0.0, c(r, k)) : c(r, k));
  return out;
}

MountSolution solution_of(const Round& round, const std::vector<MountStop>& stops) {
  const Adjusted& a = round.adjusted;
  MountSolution out;
  const LooseStops loose = loose_stops(stops);
  out.is_rotation_play_seen = loose.is_rotation_seen;
  out.is_swing_play_seen = loose.is_swing_seen;
  out.mount.rotation = a.state.rotation;
  out.mount.swing = a.state.swing;
  AxisLine* lines[2] = {&out.mount.rotation, &out.mount.swing};
  for (Eigen::Index k = 0; k < 2; ++k) {
    lines[k]->point_mm = nearest_to_origin(*lines[k]);
    const double sigma = std::sqrt(a.covariance(12 + k, 12 + k));
    if (!(lines[k]->backlash_rad > kPlaySigmas * sigma)) lines[k]->backlash_rad = 0;
  }
  for (const StopResult& stop : a.results)
    out.mount.stop_corrections.push_back({stop.pose, stop.rotation_rad, stop.swing_rad});
  out.mount.covariance = file_covariance(a);
  out.T_camera_board = a.state.T_camera_board;
  out.stops = a.results;
  out.rotation = sigma_of(a, 0);
  out.swing = sigma_of(a, 4);
  out.misfit = a.misfit * round.priors.dots;
  out.stop_sigma_rad = round.priors.angle_rad;
  out.wobble_sigma_mm = round.priors.shift_mm;
  return out;
}

}  // namespace

Result<MountSolution> solve_mount(std::vector<MountStop> stops, const TargetDesign& target, const RigState& rig,
                                  const MountOptions& options) {
  ENAMEL_TRY(check_stops(stops));
  ENAMEL_TRY_ASSIGN(MountState state, start_state(stops, target, rig));
  std::vector<StopNote> left_out;
  const auto most = static_cast<std::size_t>(options.max_gross_share * static_cast<double>(stops.size()));
  for (;;) {
    ENAMEL_TRY_ASSIGN(const Round round, settle(stops, target, rig, options, state, false));
    ENAMEL_TRY(check_slip(stops, round.adjusted, options));
    state = round.adjusted.state;
    const auto worst = worst_stop(round.adjusted, options);
    if (!worst) break;
    left_out.push_back({stops[worst->stop].view.name, worst->reason});
    if (left_out.size() > most) {
      std::string names;
      for (const StopNote& note : left_out) names += (names.empty() ? "" : ", ") + note.pose;
      return fail(ErrorCode::kCalibrationRefused,
                  fmt::format("the table slips: stops {} stand elsewhere than their angles say, more than {:.0f} % of "
                              "them; tighten the drive, then take the set again",
                              names, 100 * options.max_gross_share));
    }
    const auto at = static_cast<std::ptrdiff_t>(worst->stop);
    stops.erase(stops.begin() + at);
    state.stops.erase(state.stops.begin() + at);
    ENAMEL_TRY(check_stops(stops));
  }
  ENAMEL_TRY_ASSIGN(Round final_round, settle(stops, target, rig, options, state, true));
  Adjusted& a = final_round.adjusted;
  const LineSigma by_pictures[2] = {sigma_of(a, 0), sigma_of(a, 4)};
  if (options.rig_covariance.size() > 0)
    a.covariance += rig_share(stops, target, rig, final_round.priors, a, options.rig_covariance);
  MountSolution out = solution_of(final_round, stops);
  out.rotation_by_pictures = by_pictures[0];
  out.swing_by_pictures = by_pictures[1];
  out.has_rig_share = options.rig_covariance.size() > 0;
  out.left_out = std::move(left_out);
  return out;
}

}  // namespace enamel::calib
