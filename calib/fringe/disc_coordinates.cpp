#include "calib/fringe/disc_coordinates.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

namespace enamel::calib {
namespace {

using Eigen::Vector2d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kMinSamples = 20;

Vector6d quadratic(const Vector2d& q) {
  return (Vector6d() << 1, q.x(), q.y(), q.x() * q.x(), q.x() * q.y(), q.y() * q.y()).finished();
}

/// Scale of the sample places, so that the normal equations are well conditioned.
double reach(std::span<const ProjectorSample> samples, const Vector2d& at) {
  double r = 1;
  for (const auto& s : samples) r = std::max(r, (s.camera_px - at).cwiseAbs().maxCoeff());
  return r;
}

struct AxisFit {
  Vector6d x;
  double variance = 0;
};

std::optional<AxisFit> fit_axis(std::span<const ProjectorSample> samples, const Vector2d& at, double scale, int axis) {
  Matrix6d h = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  for (const ProjectorSample& s : samples) {
    const Vector6d j = quadratic((s.camera_px - at) / scale);
    h += j * j.transpose() / s.variance_px2[axis];
    b += j * s.projector_px[axis] / s.variance_px2[axis];
  }
  const Eigen::LDLT<Matrix6d> ldlt(h);
  if (ldlt.info() != Eigen::Success || !(ldlt.rcond() > 1e-10)) return {};
  const Vector6d x = ldlt.solve(b);
  double chi2 = 0;
  for (const ProjectorSample& s : samples) {
    const double r = s.projector_px[axis] - quadratic((s.camera_px - at) / scale).dot(x);
    chi2 += r * r / s.variance_px2[axis];
  }
  const double misfit = chi2 / static_cast<double>(samples.size() - 6);
  return AxisFit{x, ldlt.solve(Vector6d::Unit(0))[0] * std::max(1.0, misfit)};
}

}  // namespace

std::vector<ProjectorSample> disc_samples(const CoordinateMap& u, const CoordinateMap& v, const Ellipse& disc,
                                          double margin_px) {
  std::vector<ProjectorSample> out;
  const Vector2d axes = disc.half_axes();
  const double inner = 1 - margin_px / axes.y();  // the shorter half axis keeps the whole margin, the longer more
  if (!(inner > 0)) return out;
  const int reach_px = static_cast<int>(std::ceil(axes.x()));
  const int cu = static_cast<int>(std::lround(disc.centre.x())), cv = static_cast<int>(std::lround(disc.centre.y()));
  for (int y = cv - reach_px; y <= cv + reach_px; ++y) {
    for (int x = cu - reach_px; x <= cu + reach_px; ++x) {
      if (!u.value_px.contains(x, y) || disc.radius_at(Vector2d(x, y)) > inner) continue;
      const std::size_t i = u.value_px.index(x, y);
      if (std::isnan(u.value_px[i]) || std::isnan(v.value_px[i])) continue;
      out.push_back(
          {Vector2d(x, y), Vector2d(u.value_px[i], v.value_px[i]), Vector2d(u.variance_px2[i], v.variance_px2[i])});
    }
  }
  return out;
}

std::optional<LocalMap> fit_local_map(std::span<const ProjectorSample> samples, const Vector2d& at) {
  if (samples.size() < kMinSamples) return {};
  const double scale = reach(samples, at);
  LocalMap map;
  for (int axis = 0; axis < 2; ++axis) {
    const auto fit = fit_axis(samples, at, scale, axis);
    if (!fit) return {};
    map.projector_px[axis] = fit->x[0];
    map.jacobian.row(axis) = fit->x.segment<2>(1).transpose() / scale;
    map.variance_px2[axis] = fit->variance;
  }
  return map;
}

Eigen::Vector4d Ripple::harmonics(double coordinate_px, double period_px) {
  const double phase = 2 * std::numbers::pi * coordinate_px / period_px;
  return {std::sin(4 * phase), std::cos(4 * phase), std::sin(8 * phase), std::cos(8 * phase)};
}

double Ripple::at(int axis, double coordinate_px) const {
  const auto a = static_cast<std::size_t>(axis);
  if (!(period_px[a] > 0)) return 0;
  return harmonics(coordinate_px, period_px[a]).dot(coefficients_px[a]);
}

void Ripple::remove(std::span<ProjectorSample> samples) const {
  for (ProjectorSample& s : samples)
    for (int axis = 0; axis < 2; ++axis) s.projector_px[axis] -= at(axis, s.projector_px[axis]);
}

Ripple estimate_ripple(std::span<const std::vector<ProjectorSample>> discs, std::array<double, 2> period_px) {
  Ripple ripple{.period_px = period_px};
  for (int axis = 0; axis < 2; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    Eigen::Matrix4d h = Eigen::Matrix4d::Identity() * 1e-9;  // no samples: no ripple
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    for (const auto& samples : discs) {
      if (samples.size() < kMinSamples) continue;
      const Vector2d at = samples[samples.size() / 2].camera_px;
      const double scale = reach(samples, at);
      const auto fit = fit_axis(samples, at, scale, axis);
      if (!fit) continue;
      for (const ProjectorSample& s : samples) {
        const double smooth = quadratic((s.camera_px - at) / scale).dot(fit->x);
        const Eigen::Vector4d j = Ripple::harmonics(smooth, period_px[a]);
        h += j * j.transpose() / s.variance_px2[axis];
        b += j * (s.projector_px[axis] - smooth) / s.variance_px2[axis];
      }
    }
    ripple.coefficients_px[a] = h.ldlt().solve(b);
  }
  return ripple;
}

}  // namespace enamel::calib
