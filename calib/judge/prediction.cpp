#include "calib/judge/prediction.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/judge/volume_grid.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The state with its parameters moved by d, in bundle.hpp's order.
RigState moved(RigState s, const VectorXd& d) {
  const auto move_lens = [&](LensValues& l, Index at) {
    l.fx += d[at];
    l.fy += d[at + 1];
    l.cx += d[at + 2];
    l.cy += d[at + 3];
    for (std::size_t i = 0; i < 4; ++i) l.dist[i] += d[at + 4 + static_cast<Index>(i)];
  };
  move_lens(s.camera, 0);
  move_lens(s.projector, 8);
  const Eigen::AngleAxisd r(s.T_proj_cam.linear());
  const Vec3d w = r.angle() * r.axis() + Vec3d(d.segment<3>(16));
  s.T_proj_cam.linear() = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
  s.T_proj_cam.translation() += d.segment<3>(19);
  return s;
}

VectorXd stacked_um(const std::vector<Vec3d>& points) {
  VectorXd out(3 * static_cast<Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) out.segment<3>(3 * static_cast<Index>(i)) = 1e3 * points[i];
  return out;
}

/// Points that a rigid motion (rotation about `middle_mm`, then shift) moves by its six components.
MatrixXd rigid_modes(const std::vector<Vec3d>& points, const Vec3d& middle_mm) {
  MatrixXd modes(3 * static_cast<Index>(points.size()), 6);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d q = points[i] - middle_mm;
    auto rows = modes.middleRows<3>(3 * static_cast<Index>(i));
    rows.leftCols<3>() << 0, q.z(), -q.y(), -q.z(), 0, q.x(), q.y(), -q.x(), 0;
    rows.rightCols<3>().setIdentity();
  }
  return modes;
}

/// Changes of all figures with the parameters, each in units of its own sigma; the best rigid motion taken off.
struct Sensitivity {
  MatrixXd points_um;                 // three rows a point
  MatrixXd shape_um;                  // the same, the best similarity taken off
  Eigen::RowVectorXd scale_ppm;       // that a similarity would add
  std::array<MatrixXd, 3> planes_um;  // rows sag along x, twist, sag along y
};

/// What `grid` puts its points at when each parameter moves by a sigma, um, a column each.
template <class Grid>
MatrixXd by_parameters(const RigState& state, const VectorXd& sigma, const Grid& grid) {
  MatrixXd out;
  for (Index k = 0; k < sigma.size(); ++k) {
    VectorXd step = VectorXd::Zero(sigma.size());
    step[k] = sigma[k];
    const VectorXd change =
        0.5 * (stacked_um(grid(moved(state, step)).solved) - stacked_um(grid(moved(state, -step)).solved));
    if (out.size() == 0) out.resize(change.size(), sigma.size());
    out.col(k) = change;
  }
  return out;
}

/// The bend of a facing plane: what the motion that lays the volume on itself leaves of it.
MatrixXd plane_rows(const VolumePairs& plane, const MatrixXd& left_um) {
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
  MatrixXd b = MatrixXd::Zero(6, left_um.cols());
  for (std::size_t i = 0; i < plane.reference.size(); ++i) {
    const Vec3d& p = plane.reference[i];
    if (p.head<2>().cwiseAbs().maxCoeff() > kHalfFacing_mm) continue;
    const Eigen::Matrix<double, 6, 1> terms = plane_terms(p);
    h += terms * terms.transpose();
    b += terms * left_um.row(3 * static_cast<Index>(i) + 2);
  }
  return h.ldlt().solve(b).bottomRows(3);
}

Sensitivity sensitivity_of(const RigState& state, const VectorXd& sigma, DepthRange range, const VolumePairs& volume) {
  Sensitivity s;
  Vec3d middle_mm = Vec3d::Zero();
  for (const Vec3d& p : volume.solved) middle_mm += p / static_cast<double>(volume.solved.size());
  const MatrixXd moves = by_parameters(state, sigma, [&](const RigState& r) { return volume_pairs(r, state, range); });
  const MatrixXd modes = rigid_modes(volume.solved, middle_mm);
  const MatrixXd motion = (modes.transpose() * modes).ldlt().solve(modes.transpose() * moves);
  s.points_um = moves - modes * motion;
  VectorXd radial = 1e-3 * stacked_um(volume.solved);
  for (Index i = 0; i < radial.size(); i += 3) radial.segment<3>(i) -= middle_mm;
  const Eigen::RowVectorXd growth = radial.transpose() * s.points_um / radial.squaredNorm();
  s.scale_ppm = -1e3 * growth;  // um per mm
  s.shape_um = s.points_um - radial * growth;
  const auto depths_mm = plane_depths_mm(range);
  for (std::size_t k = 0; k < depths_mm.size(); ++k) {
    const auto grid = [&](const RigState& r) {
      VolumePairs plane;
      add_depth(r, state, depths_mm[k], plane);
      return plane;
    };
    const VolumePairs plane = grid(state);
    s.planes_um[k] =
        plane_rows(plane, by_parameters(state, sigma, grid) - rigid_modes(plane.solved, middle_mm) * motion);
  }
  return s;
}

/// Lengths of the points' moves, unordered.
std::vector<double> lengths(const VectorXd& moves) {
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(moves.size() / 3));
  for (Index i = 0; i < moves.size(); i += 3) out.push_back(moves.segment<3>(i).norm());
  return out;
}

double p95_of(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 95 / 100);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

VolumeDifference difference_of(const Sensitivity& s, const VectorXd& x) {
  VolumeDifference d;
  const std::vector<double> off = lengths(s.points_um * x);
  double squares = 0;
  for (const double value : off) squares += value * value;
  d.rms_um = std::sqrt(squares / static_cast<double>(off.size()));
  d.max_um = *std::max_element(off.begin(), off.end());
  d.p95_um = p95_of(off);
  d.shape_p95_um = p95_of(lengths(s.shape_um * x));
  d.scale_ppm = s.scale_ppm * x;
  for (std::size_t k = 0; k < d.planes.size(); ++k) {
    const VectorXd bend = s.planes_um[k] * x;
    d.planes[k] = {bend[0], bend[2], bend[1]};
  }
  return d;
}

/// Nearest-rank quantile of the magnitudes of `value` over all draws.
template <class Value>
double quantile_of(const std::vector<VolumeDifference>& all, double quantile, const Value& value) {
  std::vector<double> values;
  values.reserve(all.size());
  for (const VolumeDifference& d : all) values.push_back(std::abs(value(d)));
  const auto at = static_cast<std::ptrdiff_t>(std::lround(quantile * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace

Prediction::Prediction(const RigState& state, const Eigen::MatrixXd& covariance, DepthRange range, int draws)
    : depth_mm_(plane_depths_mm(range)) {
  const VolumePairs volume = volume_pairs(state, state, range);
  if (volume.solved.empty()) return;
  // Variances span ten powers of ten, from a rotation's to a focal length's: the root is taken of the correlations.
  const VectorXd sigma = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const MatrixXd correlation = sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
  const MatrixXd root = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  const Sensitivity sensitivity = sensitivity_of(state, sigma, range, volume);
  Rng rng(1, 0, 1);
  draws_.reserve(static_cast<std::size_t>(draws));
  for (int k = 0; k < draws; ++k) {
    VectorXd z(covariance.rows());
    for (double& value : z) value = rng.normal();
    draws_.push_back(difference_of(sensitivity, root * z));
  }
}

VolumeDifference Prediction::at(double quantile) const {
  VolumeDifference out;
  out.depth_mm = depth_mm_;
  if (draws_.empty()) return out;
  const auto of = [&](const auto& value) { return quantile_of(draws_, quantile, value); };
  out.p95_um = of([](const auto& d) { return d.p95_um; });
  out.shape_p95_um = of([](const auto& d) { return d.shape_p95_um; });
  out.rms_um = of([](const auto& d) { return d.rms_um; });
  out.max_um = of([](const auto& d) { return d.max_um; });
  out.scale_ppm = of([](const auto& d) { return d.scale_ppm; });
  for (std::size_t k = 0; k < out.planes.size(); ++k) {
    out.planes[k].sag_x_um = of([k](const auto& d) { return d.planes[k].sag_x_um; });
    out.planes[k].sag_y_um = of([k](const auto& d) { return d.planes[k].sag_y_um; });
    out.planes[k].twist_um = of([k](const auto& d) { return d.planes[k].twist_um; });
  }
  return out;
}

}  // namespace enamel::calib
