#include "calib/target/disc_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace enamel::calib {
namespace {

constexpr int kParameters = 10;  // centre 2, shape 3, blur, ground, step, illumination gradient 2
constexpr int kMaxSteps = 25;
constexpr double kConverged_px = 1e-6;
constexpr double kConvergedBlur_px = 1e-4;
constexpr double kMaxDamping = 1e6;
constexpr double kFirstBlur_px = 0.6;
constexpr double kMinBlur_px = 0.15;  // a sharper edge cannot be told from this one on a pixel grid

using Params = Eigen::Matrix<double, kParameters, 1>;
using Normal = Eigen::Matrix<double, kParameters, kParameters>;

struct Window {
  int u0 = 0, v0 = 0, u1 = -1, v1 = -1;
};

/// Pixels that may lie within `reach_px` of the ellipse; empty when that leaves the image.
std::optional<Window> window_around(const Map<float>& image, const Ellipse& e, double reach_px) {
  const Eigen::Matrix2d spread = e.shape.inverse();
  if (!(spread(0, 0) > 0 && spread(1, 1) > 0) || !spread.allFinite() || !e.centre.allFinite()) return {};
  const double du = std::sqrt(spread(0, 0)) + reach_px;
  const double dv = std::sqrt(spread(1, 1)) + reach_px;
  if (!(du < image.width() && dv < image.height())) return {};
  const Window w{static_cast<int>(std::floor(e.centre.x() - du)), static_cast<int>(std::floor(e.centre.y() - dv)),
                 static_cast<int>(std::ceil(e.centre.x() + du)), static_cast<int>(std::ceil(e.centre.y() + dv))};
  if (!image.contains(w.u0, w.v0) || !image.contains(w.u1, w.v1)) return {};
  return w;
}

/// Signed distance to the contour, px, positive inside: first order in the distance (Taubin 1991).
double inside_px(double f, double gradient) { return (1.0 - f) * f / gradient; }

struct Sample {
  double value = 0;
  Eigen::Vector2d p;
  double weight = 0;  // 1 / variance, of the model's value at the last accepted step
};

std::vector<Sample> samples_of(const Map<float>& image, const Ellipse& e, const Window& w, double reach_px) {
  std::vector<Sample> out;
  for (int v = w.v0; v <= w.v1; ++v) {
    for (int u = w.u0; u <= w.u1; ++u) {
      const Eigen::Vector2d p(u, v);
      const Eigen::Vector2d g = e.shape * (p - e.centre);
      const double f = e.radius_at(p);
      if (f > 1 && inside_px(f, g.norm()) < -reach_px) continue;
      out.push_back({static_cast<double>(image(u, v)), p, 0.0});
    }
  }
  return out;
}

/// Model value at p and its derivatives. Intensity = (1 + g·q)(ground + step·cover), cover by edge_spread.
double model(EdgeModel edges, const Params& x, const Eigen::Vector2d& p, Params& derivative) {
  const Eigen::Vector2d q = p - x.head<2>();
  const Eigen::Vector2d mq(x[2] * q.x() + x[3] * q.y(), x[3] * q.x() + x[4] * q.y());
  const double f = std::sqrt(std::max(q.dot(mq), 1e-12));
  const double n = std::max(mq.norm(), 1e-9);
  const double curvature = (x[2] * x[4] - x[3] * x[3]) * f * f / (n * n * n);  // of the level curve through p
  const EdgeSpread edge = edge_spread(edges, inside_px(f, n), mq / n, x[5], curvature);
  const double light = 1 + x[8] * q.x() + x[9] * q.y();
  const double level = x[6] + x[7] * edge.cover;
  const double slope = light * x[7] * edge.by_distance;
  derivative[0] = slope * mq.x() / n - x[8] * level;
  derivative[1] = slope * mq.y() / n - x[9] * level;
  derivative[2] = -slope * q.x() * q.x() / (2 * n);
  derivative[3] = -slope * q.x() * q.y() / n;
  derivative[4] = -slope * q.y() * q.y() / (2 * n);
  derivative[5] = light * x[7] * edge.by_blur;
  derivative[6] = light;
  derivative[7] = light * edge.cover;
  derivative[8] = level * q.x();
  derivative[9] = level * q.y();
  return light * level;
}

/// Weighted sum of squares at x with the weights that stand.
double chi2_at(EdgeModel edges, const std::vector<Sample>& samples, const Params& x) {
  double chi2 = 0;
  Params unused;
  for (const Sample& s : samples) {
    const double r = s.value - model(edges, x, s.p, unused);
    chi2 += s.weight * r * r;
  }
  return chi2;
}

/// Renews the weights at x, fills the normal equations and returns the sum of squares.
double assemble(EdgeModel edges, std::vector<Sample>& samples, const PixelNoise& noise, const Params& x, Normal& h,
                Params& b) {
  double chi2 = 0;
  Params j;
  h.setZero();
  b.setZero();
  for (Sample& s : samples) {
    const double predicted = model(edges, x, s.p, j);
    s.weight = 1.0 / noise.variance(predicted);
    const double r = s.value - predicted;
    chi2 += s.weight * r * r;
    h.selfadjointView<Eigen::Lower>().rankUpdate(j, s.weight);
    b += s.weight * r * j;
  }
  return chi2;
}

bool is_plausible(const Params& x) {
  return x.allFinite() && x[5] >= kMinBlur_px && x[2] > 0 && x[4] > 0 && x[2] * x[4] > x[3] * x[3];
}

/// Levenberg and Marquardt with the diagonal as its scale.
bool minimise(EdgeModel edges, std::vector<Sample>& samples, const PixelNoise& noise, Params& x, Normal& h,
              double& chi2) {
  double damping = 1e-4;
  Params b;
  chi2 = assemble(edges, samples, noise, x, h, b);
  for (int step = 0; step < kMaxSteps; ++step) {
    Normal damped = h.selfadjointView<Eigen::Lower>();
    damped.diagonal() *= 1 + damping;
    const Params dx = damped.ldlt().solve(b);
    Params next = x + dx;
    next[5] = std::max(next[5], kMinBlur_px);
    const bool is_small = dx.head<2>().norm() < kConverged_px && std::abs(dx[5]) < kConvergedBlur_px;
    if (!is_plausible(next) || chi2_at(edges, samples, next) > chi2) {
      if (is_small) return true;
      damping = std::max(damping * 10, 1e-4);
      if (damping > kMaxDamping) return false;
      continue;
    }
    x = next;
    chi2 = assemble(edges, samples, noise, x, h, b);
    damping *= 0.1;
    if (is_small) return true;
  }
  return false;
}

/// Median of the pixels well outside and well inside: start values of the levels.
std::pair<double, double> start_levels(const std::vector<Sample>& samples, const Ellipse& e) {
  std::vector<double> out, in;
  const double px = e.half_axes().y();
  for (const Sample& s : samples) {
    const double f = e.radius_at(s.p);
    if (f < 1 - 1.5 / px) in.push_back(s.value);
    if (f > 1 + 1.5 / px) out.push_back(s.value);
  }
  const auto median = [](std::vector<double>& v) {
    if (v.empty()) return 0.0;
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  const double ground = median(out);
  return {ground, median(in) - ground};
}

}  // namespace

Eigen::Vector2d Ellipse::half_axes() const {
  const Eigen::Vector2d eigen = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(shape).eigenvalues();
  return {1 / std::sqrt(eigen[0]), 1 / std::sqrt(eigen[1])};
}

std::optional<Ellipse> disc_moments(const Map<float>& image, const Ellipse& seed, double reach_px) {
  const auto window = window_around(image, seed, reach_px);
  if (!window) return {};
  const auto samples = samples_of(image, seed, *window, reach_px);
  const auto [ground, step] = start_levels(samples, seed);
  if (std::abs(step) < 1e-6) return {};
  double mass = 0;
  Eigen::Vector2d first(0, 0);
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (const Sample& s : samples) {
    const double cover = std::clamp((s.value - ground) / step, 0.0, 1.0);
    const double weight = cover < 0.1 ? 0.0 : cover;  // noise of the ground would pull towards the window's middle
    const Eigen::Vector2d q = s.p - seed.centre;
    mass += weight;
    first += weight * q;
    second += weight * q * q.transpose();
  }
  if (mass < 9) return {};
  first /= mass;
  second = second / mass - first * first.transpose();
  if (!(second.determinant() > 1e-3)) return {};
  // The second moments of a uniform ellipse are a quarter of its squared half axes.
  return Ellipse{seed.centre + first, second.inverse() / 4};
}

std::optional<DiscFit> fit_disc(const Map<float>& image, const PixelNoise& noise, const Ellipse& start, double reach_px,
                                EdgeModel edges) {
  const auto window = window_around(image, start, reach_px);
  if (!window) return {};
  std::vector<Sample> samples = samples_of(image, start, *window, reach_px);
  const auto [ground, step] = start_levels(samples, start);
  if (samples.size() < 3 * kParameters || std::abs(step) < 3 * std::sqrt(noise.variance(ground))) return {};
  Params x;
  x << start.centre, start.shape(0, 0), start.shape(0, 1), start.shape(1, 1), kFirstBlur_px, ground, step, 0, 0;
  Normal h;
  double chi2 = 0;
  if (!minimise(edges, samples, noise, x, h, chi2)) return {};
  DiscFit fit;
  fit.ellipse.centre = x.head<2>();
  fit.ellipse.shape << x[2], x[3], x[3], x[4];
  fit.blur_px = x[5];
  fit.ground_dn = x[6];
  fit.step_dn = x[7];
  const auto dof = static_cast<double>(samples.size() - kParameters);
  fit.misfit = chi2 / dof;
  double squares = 0;
  Params unused;
  for (const Sample& s : samples) squares += std::pow(s.value - model(edges, x, s.p, unused), 2);
  fit.residual_share = std::sqrt(squares / dof) / std::abs(x[7]);
  const Normal full = h.selfadjointView<Eigen::Lower>();
  const Normal covariance = full.ldlt().solve(Normal::Identity());
  fit.covariance = covariance.topLeftCorner<2, 2>() * std::max(1.0, fit.misfit);
  return fit;
}

}  // namespace enamel::calib
