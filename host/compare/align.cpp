#include "host/compare/align.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace enamel::host {
namespace {

constexpr double kFarMm = 48.0;
constexpr std::size_t kCoarsePoints = 1500;
constexpr std::size_t kFinePoints = 20000;
constexpr int kCoarseRounds = 15;
constexpr int kFineRounds = 40;
constexpr double kFitsMm = 0.2;  ///< median distance below which a start needs no rival

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

std::vector<Vec3d> sampled(const Mesh& mesh, std::size_t most) {
  const std::size_t step = std::max<std::size_t>(1, mesh.vertices.size() / most);
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += step) {
    points.push_back(mesh.vertices[i].cast<double>());
  }
  return points;
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return 0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Round {
  Pose step = Pose::Identity();
  double median_mm = 0;  ///< absolute distance before the step
};

// One Gauss-Newton step of point-to-plane with Welsch weights of three median absolute distances.
Round round_of(const std::vector<Vec3d>& points, const Pose& T, const SignedSurface& reference) {
  std::vector<SignedDistance> hits;
  std::vector<double> distances;
  for (const Vec3d& p : points) {
    hits.push_back(reference.distance(T * p));
    distances.push_back(std::abs(hits.back().distance_mm));
  }
  Round round;
  round.median_mm = median(distances);
  const double scale = std::max(3.0 * round.median_mm, 1e-6);
  Matrix6 A = Matrix6::Zero();
  Vector6 b = Vector6::Zero();
  Vec3d centre = Vec3d::Zero();
  for (const SignedDistance& hit : hits) {
    centre += hit.point / static_cast<double>(hits.size());
  }
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Vec3d q = T * points[i];
    const double r = hits[i].normal.dot(q - hits[i].point);
    const double w = std::exp(-(distances[i] / scale) * (distances[i] / scale));
    Vector6 J;
    J << (q - centre).cross(hits[i].normal), hits[i].normal;
    A += w * J * J.transpose();
    b -= w * r * J;
  }
  A.diagonal().array() += 1e-9 * A.trace();  // keeps what the surface does not fix where it is
  const Vector6 x = A.ldlt().solve(b);
  const double angle = x.head<3>().norm();
  const Eigen::Matrix3d R =
      angle > 0 ? Eigen::AngleAxisd(angle, x.head<3>() / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
  round.step.linear() = R;
  round.step.translation() = centre + x.tail<3>() - R * centre;
  return round;
}

/// Moves T; returns the median distance at the end.
double refine(const std::vector<Vec3d>& points, const SignedSurface& reference, int rounds, Pose& T) {
  for (int k = 0; k < rounds; ++k) {
    const Round round = round_of(points, T, reference);
    T = round.step * T;
    const double turn = Eigen::AngleAxisd(round.step.linear()).angle();
    const double shift = (round.step * points.front() - points.front()).norm();
    if (turn < 1e-9 && shift < 1e-7) {
      break;
    }
  }
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return round_of(points, T, reference).median_mm;
}

struct Frame {
  Vec3d centre = Vec3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns, right-handed
};

Frame principal(const std::vector<Vec3d>& points) {
  Frame frame;
  for (const Vec3d& p : points) {
    frame.centre += p / static_cast<double>(points.size());
  }
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  for (const Vec3d& p : points) {
    C += (p - frame.centre) * (p - frame.centre).transpose();
  }
  frame.axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(C).eigenvectors();
  if (frame.axes.determinant() < 0) {
    frame.axes.col(0) *= -1.0;
  }
  return frame;
}

std::vector<Pose> starts(const std::vector<Vec3d>& points, const SignedSurface& reference) {
  const Frame from = principal(points);
  const Frame to = principal(sampled(reference.mesh(), kCoarsePoints));
  std::vector<Pose> out;
  Pose shift = Pose::Identity();
  shift.translation() = to.centre - from.centre;
  out.push_back(shift);
  for (const Vec3d& flip : {Vec3d(1, 1, 1), Vec3d(1, -1, -1), Vec3d(-1, 1, -1), Vec3d(-1, -1, 1)}) {
    Pose T = Pose::Identity();
    T.linear() = to.axes * flip.asDiagonal() * from.axes.transpose();
    T.translation() = to.centre - T.linear() * from.centre;
    out.push_back(T);
  }
  return out;
}

std::optional<double> scale_ppm(const std::vector<Vec3d>& estimate, const std::vector<Vec3d>& truth) {
  if (estimate.size() < 3) {
    return std::nullopt;
  }
  Eigen::Matrix3Xd P(3, static_cast<Eigen::Index>(estimate.size()));
  Eigen::Matrix3Xd Q = P;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    P.col(static_cast<Eigen::Index>(i)) = estimate[i];
    Q.col(static_cast<Eigen::Index>(i)) = truth[i];
  }
  const Vec3d span = Q.rowwise().maxCoeff() - Q.rowwise().minCoeff();
  if (span.norm() < 1.0) {
    return std::nullopt;
  }
  const Eigen::Matrix4d S = Eigen::umeyama(P, Q, true);
  return (1.0 / S.block<3, 1>(0, 0).norm() - 1.0) * 1e6;
}

}  // namespace

Result<StartAlignment> align_start(const std::vector<PoseRow>& estimate, const std::vector<PoseRow>& truth) {
  std::vector<std::pair<const PoseRow*, const PoseRow*>> common;
  for (std::size_t e = 0, t = 0; e < estimate.size() && t < truth.size();) {  // both in order of burst
    if (estimate[e].burst_id == truth[t].burst_id) {
      common.emplace_back(&estimate[e++], &truth[t++]);
    } else {
      ++(estimate[e].burst_id < truth[t].burst_id ? e : t);
    }
  }
  if (common.empty()) {
    return fail(ErrorCode::kBurstNotFound, "the two pose files have no burst in common");
  }
  StartAlignment out;
  out.T_truth_estimate = common.front().second->T_model_cam * common.front().first->T_model_cam.inverse();
  const Vec3d far(0, 0, kFarMm);
  std::vector<Vec3d> from;
  std::vector<Vec3d> to;
  for (const auto& [e, t] : common) {
    from.push_back(out.T_truth_estimate * e->T_model_cam * far);
    to.push_back(t->T_model_cam * far);
  }
  const Eigen::Matrix3d left = (out.T_truth_estimate * common.back().first->T_model_cam).linear().transpose() *
                               common.back().second->T_model_cam.linear();
  out.end.end_error_um = 1e3 * (from.back() - to.back()).norm();
  out.end.end_rotation_deg = Eigen::AngleAxisd(left).angle() * (180.0 / M_PI);
  out.end.scale_ppm = scale_ppm(from, to);
  return out;
}

Pose align_best(const Mesh& mesh, const SignedSurface& reference, const Pose& T_reference_mesh) {
  const std::vector<Vec3d> coarse = sampled(mesh, kCoarsePoints);
  Pose best = T_reference_mesh;
  double best_mm = refine(coarse, reference, kCoarseRounds, best);
  if (best_mm > kFitsMm) {
    for (Pose T : starts(coarse, reference)) {
      const double mm = refine(coarse, reference, kCoarseRounds, T);
      if (mm < best_mm) {
        best_mm = mm;
        best = T;
      }
    }
  }
  refine(sampled(mesh, kFinePoints), reference, kFineRounds, best);
  return best;
}

}  // namespace enamel::host
