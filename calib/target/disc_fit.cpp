#include "calib/target/disc_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
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

constexpr double kLeastReach_px = 8;  ///< ground between disc and border of the image; less leaves its light uncertain

/// Pixels of the image that may lie within `reach_px` of the ellipse; empty when the border comes nearer than that and
/// than kLeastReach_px.
std::optional<PixelWindow> window_around(const Map<float>& image, const Ellipse& e, double reach_px) {
  const Eigen::Matrix2d spread = e.shape.inverse();
  if (!(spread(0, 0) > 0 && spread(1, 1) > 0) || !spread.allFinite() || !e.centre.allFinite()) return {};
  const auto within = [&](double reach) {
    const double du = std::sqrt(spread(0, 0)) + reach, dv = std::sqrt(spread(1, 1)) + reach;
    return Eigen::AlignedBox2d(e.centre - Eigen::Vector2d(du, dv), e.centre + Eigen::Vector2d(du, dv));
  };
  const Eigen::AlignedBox2d pixels(Eigen::Vector2d(0, 0), Eigen::Vector2d(image.width() - 1, image.height() - 1));
  if (!pixels.contains(within(std::min(reach_px, kLeastReach_px)))) return {};
  const Eigen::AlignedBox2d box = within(reach_px).intersection(pixels);
  return PixelWindow{static_cast<int>(std::floor(box.min().x())), static_cast<int>(std::floor(box.min().y())),
                     static_cast<int>(std::ceil(box.max().x())), static_cast<int>(std::ceil(box.max().y()))};
}

struct Sample {
  double value = 0;
  Eigen::Vector2d p;
  double weight = 0;  // 1 / variance, of the model's value at the last accepted step
};

std::vector<Sample> samples_of(const Map<float>& image, const Ellipse& e, const PixelWindow& w, double reach_px) {
  std::vector<Sample> out;
  for (int v = w.v0; v <= w.v1; ++v) {
    for (int u = w.u0; u <= w.u1; ++u) {
      const Eigen::Vector2d p(u, v);
      if (inside_px(e, p) < -reach_px) continue;
      out.push_back({static_cast<double>(image(u, v)), p, 0.0});
    }
  }
  return out;
}

Ellipse ellipse_of(const Params& x) {
  Ellipse e{x.head<2>(), {}};
  e.shape << x[2], x[3], x[3], x[4];
  return e;
}

/// Model value at p and its derivatives. Intensity = (1 + g·q)(ground + step·cover).
double model(const CoverJet& jet, const Params& x, const Eigen::Vector2d& p, Params& derivative) {
  const Eigen::Vector2d q = p - x.head<2>();
  const double light = 1 + x[8] * q.x() + x[9] * q.y();
  const double level = x[6] + x[7] * jet.cover;
  derivative.head<6>() = light * x[7] * jet.slope;
  derivative[0] -= x[8] * level;
  derivative[1] -= x[9] * level;
  derivative[6] = light;
  derivative[7] = light * jet.cover;
  derivative[8] = level * q.x();
  derivative[9] = level * q.y();
  return light * level;
}

/// The least-squares problem of one disc.
class Problem {
 public:
  Problem(std::vector<Sample> samples, const PixelNoise& noise, DiscCover cover)
      : samples_(std::move(samples)), noise_(noise), cover_(std::move(cover)) {}

  /// Weighted sum of squares at x with the weights that stand.
  double chi2_at(const Params& x) {
    cover_.render(ellipse_of(x), x[5]);
    double chi2 = 0;
    Params unused;
    for (const Sample& s : samples_) chi2 += s.weight * std::pow(s.value - model(cover_.at(s.p), x, s.p, unused), 2);
    return chi2;
  }

  /// Renews the weights at x, where chi2_at was called last, fills the normal equations and returns the sum of squares.
  double assemble(const Params& x, Normal& h, Params& b) {
    double chi2 = 0;
    Params j;
    h.setZero();
    b.setZero();
    for (Sample& s : samples_) {
      const double predicted = model(cover_.at(s.p), x, s.p, j);
      s.weight = 1.0 / noise_.variance(predicted);
      const double r = s.value - predicted;
      chi2 += s.weight * r * r;
      h.selfadjointView<Eigen::Lower>().rankUpdate(j, s.weight);
      b += s.weight * r * j;
    }
    return chi2;
  }

  /// Sum of squares at x, DN².
  double squares_at(const Params& x) {
    for (Sample& s : samples_) s.weight = 1;
    return chi2_at(x);
  }

  [[nodiscard]] double freedom() const { return static_cast<double>(samples_.size() - kParameters); }

 private:
  std::vector<Sample> samples_;
  PixelNoise noise_;
  DiscCover cover_;
};

bool is_plausible(const Params& x) {
  return x.allFinite() && x[5] >= kMinBlur_px && x[2] > 0 && x[4] > 0 && x[2] * x[4] > x[3] * x[3];
}

/// Levenberg and Marquardt with the diagonal as its scale.
bool minimise(Problem& problem, Params& x, Normal& h, double& chi2) {
  double damping = 1e-4;
  Params b;
  problem.chi2_at(x);
  chi2 = problem.assemble(x, h, b);
  for (int step = 0; step < kMaxSteps; ++step) {
    Normal damped = h.selfadjointView<Eigen::Lower>();
    damped.diagonal() *= 1 + damping;
    const Params dx = damped.ldlt().solve(b);
    Params next = x + dx;
    next[5] = std::max(next[5], kMinBlur_px);
    const bool is_small = dx.head<2>().norm() < kConverged_px && std::abs(dx[5]) < kConvergedBlur_px;
    if (!is_plausible(next) || problem.chi2_at(next) > chi2) {
      if (is_small) return true;
      damping = std::max(damping * 10, 1e-4);
      if (damping > kMaxDamping) return false;
      continue;
    }
    x = next;
    chi2 = problem.assemble(x, h, b);
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
  Problem problem(std::move(samples), noise, DiscCover(edges, *window, start));
  Normal h;
  double chi2 = 0;
  if (!minimise(problem, x, h, chi2)) return {};
  DiscFit fit;
  fit.ellipse = ellipse_of(x);
  fit.blur_px = x[5];
  fit.ground_dn = x[6];
  fit.step_dn = x[7];
  fit.misfit = chi2 / problem.freedom();
  fit.residual_share = std::sqrt(problem.squares_at(x) / problem.freedom()) / std::abs(x[7]);
  const Normal full = h.selfadjointView<Eigen::Lower>();
  const Normal covariance = full.ldlt().solve(Normal::Identity());
  fit.covariance = covariance.topLeftCorner<2, 2>() * std::max(1.0, fit.misfit);
  return fit;
}

}  // namespace enamel::calib
