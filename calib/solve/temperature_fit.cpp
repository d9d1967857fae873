#include "calib/solve/temperature_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/solve/bundle.hpp"

namespace enamel::calib {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMinSpan_k = 3, kMaxSigmas = 5;
constexpr Index kRotation = 16;  // of the parameters' order
/// The parameters that drift, in TemperatureFit::sigma's order.
constexpr std::array<Index, kTemperatureRates> kDrifting{0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 20, 21};

Vec3d log_of(const Matrix3d& r) {
  const Eigen::AngleAxisd turn(r);
  return turn.angle() * turn.axis();
}

Matrix3d turned_by(const Vec3d& w) {
  return w.norm() > 0 ? Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() : Matrix3d::Identity();
}

/// d log(exp(w + dw) exp(w)ᵀ) / d dw: from a step of the rotation vector to the small turn applied after exp(w).
Matrix3d left_jacobian(const Vec3d& w) {
  const double a = w.norm();
  Matrix3d cross;
  cross << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  if (a < 1e-8) return Matrix3d::Identity() + 0.5 * cross;
  return Matrix3d::Identity() + (1 - std::cos(a)) / (a * a) * cross + (a - std::sin(a)) / (a * a * a) * cross * cross;
}

/// Parameters with the rotation as a small turn from `base`.
VectorXd values_of(const RigState& s, const Matrix3d& base) {
  VectorXd p(kRigParameters);
  const auto put = [&](const LensValues& l, Index at) {
    p.segment(at, 8) << l.fx, l.fy, l.cx, l.cy, l.dist[0], l.dist[1], l.dist[2], l.dist[3];
  };
  put(s.camera, 0);
  put(s.projector, 8);
  p.segment<3>(kRotation) = log_of(s.T_proj_cam.linear() * base.transpose());
  p.tail<3>() = s.T_proj_cam.translation();
  return p;
}

void set_values(RigState& s, const VectorXd& p, const Matrix3d& base) {
  const auto take = [&](LensValues& l, Index at) {
    l.fx = p[at];
    l.fy = p[at + 1];
    l.cx = p[at + 2];
    l.cy = p[at + 3];
    for (Index k = 0; k < 4; ++k) l.dist[static_cast<std::size_t>(k)] = p[at + 4 + k];
  };
  take(s.camera, 0);
  take(s.projector, 8);
  s.T_proj_cam.linear() = turned_by(p.segment<3>(kRotation)) * base;
  s.T_proj_cam.translation() = p.tail<3>();
}

TemperatureTerms terms_of(const VectorXd& rates, double reference_c, std::array<double, 2> range_c) {
  TemperatureTerms t;
  t.reference_c = reference_c;
  t.range_c = range_c;
  t.camera = {rates[0], rates[1], rates[2], rates[3]};
  t.projector = {rates[4], rates[5], rates[6], rates[7]};
  for (std::size_t k = 0; k < 3; ++k) {
    t.rotation_rad[k] = rates[8 + static_cast<Index>(k)];
    t.translation_mm[k] = rates[11 + static_cast<Index>(k)];
  }
  return t;
}

Result<void> check_sets(const std::vector<RigAtTemperature>& sets) {
  if (sets.size() < 2) return fail(ErrorCode::kCalibrationPoses, "temperature terms want two calibrations or more");
  const auto by_temperature = [](const RigAtTemperature& a, const RigAtTemperature& b) { return a.temp_c < b.temp_c; };
  const auto [low, high] = std::minmax_element(sets.begin(), sets.end(), by_temperature);
  if (!(high->temp_c - low->temp_c >= kMinSpan_k)) {
    return fail(ErrorCode::kCalibrationPoses,
                fmt::format("the calibrations lie {:.1f} K apart; take them at least {:.0f} K apart",
                            high->temp_c - low->temp_c, kMinSpan_k));
  }
  const auto same_size = [](const LensValues& a, const LensValues& b) {
    return a.width == b.width && a.height == b.height;
  };
  for (const RigAtTemperature& s : sets) {
    if (s.covariance.rows() != kRigParameters || s.covariance.cols() != kRigParameters)
      return fail(ErrorCode::kRigInvalid, fmt::format("the calibration at {:.1f} C states no covariance", s.temp_c));
    if (s.state.correction) {
      return fail(
          ErrorCode::kRigInvalid,
          fmt::format("the calibration at {:.1f} C has a correction field, which belongs to its own lens values",
                      s.temp_c));
    }
    if (!same_size(s.state.camera, sets[0].state.camera) || !same_size(s.state.projector, sets[0].state.projector))
      return fail(ErrorCode::kRigInvalid, "the calibrations are of different image or projector sizes");
  }
  return {};
}

constexpr Index kUnknowns = kRigParameters + kTemperatureRates;

/// Normal equations of y = p + kelvins D b over the sets.
struct Sums {
  MatrixXd H = MatrixXd::Zero(kUnknowns, kUnknowns);
  VectorXd b = VectorXd::Zero(kUnknowns);
  double squares = 0;

  /// Error: kRigInvalid for a covariance that is none.
  Result<void> add(const MatrixXd& covariance, const VectorXd& y, double kelvins) {
    MatrixXd J = MatrixXd::Zero(kRigParameters, kUnknowns);
    J.leftCols(kRigParameters).setIdentity();
    for (Index k = 0; k < kTemperatureRates; ++k)
      J(kDrifting[static_cast<std::size_t>(k)], kRigParameters + k) = kelvins;
    const Eigen::LLT<MatrixXd> root(covariance);
    if (root.info() != Eigen::Success) return fail(ErrorCode::kRigInvalid, "a covariance is not positive");
    H += J.transpose() * root.solve(J);
    b += J.transpose() * root.solve(y);
    squares += y.dot(root.solve(y));
    return {};
  }
};

}  // namespace

Result<TemperatureFit> fit_temperature(const std::vector<RigAtTemperature>& sets) {
  ENAMEL_TRY(check_sets(sets));
  const Matrix3d base = sets[0].state.T_proj_cam.linear();
  MatrixXd turn = MatrixXd::Identity(kRigParameters, kRigParameters);
  turn.block<3, 3>(kRotation, kRotation) = left_jacobian(log_of(base));

  double reference_c = 0;
  std::array<double, 2> range_c{sets[0].temp_c, sets[0].temp_c};
  for (const RigAtTemperature& s : sets) {
    reference_c += s.temp_c / static_cast<double>(sets.size());
    range_c = {std::min(range_c[0], s.temp_c), std::max(range_c[1], s.temp_c)};
  }
  // Pixels, radians and coefficients differ by orders of magnitude: worked in units of the first set's sigma.
  const VectorXd unit = (turn * sets[0].covariance * turn.transpose()).diagonal().cwiseSqrt();
  if (!(unit.minCoeff() > 0)) return fail(ErrorCode::kRigInvalid, "a covariance is not positive");
  const VectorXd start = values_of(sets[0].state, base);
  Sums sums;
  for (const RigAtTemperature& s : sets) {
    const MatrixXd scaled = unit.cwiseInverse().asDiagonal() * turn;
    const VectorXd y = unit.cwiseInverse().asDiagonal() * (values_of(s.state, base) - start);
    ENAMEL_TRY(sums.add(scaled * s.covariance * scaled.transpose(), y, s.temp_c - reference_c));
  }
  const Eigen::LDLT<MatrixXd> normal(sums.H);
  const VectorXd x = normal.solve(sums.b);
  const MatrixXd spread = normal.solve(MatrixXd::Identity(kUnknowns, kUnknowns));

  TemperatureFit fit;
  fit.chi2 = sums.squares - sums.b.dot(x);
  fit.degrees = kRigParameters * static_cast<int>(sets.size()) - static_cast<int>(kUnknowns);
  if (fit.chi2 > fit.degrees + kMaxSigmas * std::sqrt(2.0 * fit.degrees)) {
    return fail(ErrorCode::kCalibrationRefused,
                fmt::format("the calibrations differ by more than a drift with temperature (chi2 {:.0f} of {}): one of "
                            "them is damaged, or the probe was changed between them",
                            fit.chi2, fit.degrees));
  }
  fit.state = sets[0].state;
  fit.state.T_cam_target.clear();
  set_values(fit.state, start + VectorXd(unit.cwiseProduct(x.head(kRigParameters))), base);
  MatrixXd back = unit.asDiagonal();
  back.middleRows<3>(kRotation) = left_jacobian(log_of(base)).inverse() * back.middleRows<3>(kRotation);
  fit.covariance = back * spread.topLeftCorner(kRigParameters, kRigParameters) * back.transpose();
  VectorXd rates(kTemperatureRates);
  for (Index k = 0; k < kTemperatureRates; ++k) {
    const double u = unit[kDrifting[static_cast<std::size_t>(k)]];
    rates[k] = u * x[kRigParameters + k];
    fit.sigma[k] = u * std::sqrt(spread(kRigParameters + k, kRigParameters + k));
  }
  fit.terms = terms_of(rates, reference_c, range_c);
  return fit;
}

}  // namespace enamel::calib
