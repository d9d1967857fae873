#include "pipeline/register/icp/texture_term.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/register/icp/texture_search.hpp"
#include "pipeline/register/icp/texture_sums.hpp"

namespace enamel::pipeline {
namespace {

/// (1 2 1)/4 along both directions; borders repeat, what is unknown (NaN) spreads.
Map<float> smoothed(const Map<float>& in) {
  const int w = in.width(), h = in.height();
  Map<float> across(w, h), out(w, h);
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u)
      across(u, v) = 0.25F * (in(std::max(u - 1, 0), v) + 2 * in(u, v) + in(std::min(u + 1, w - 1), v));
  }
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u)
      out(u, v) = 0.25F * (across(u, std::max(v - 1, 0)) + 2 * across(u, v) + across(u, std::min(v + 1, h - 1)));
  }
  return out;
}

/// What texture holds, and where it would move that.
struct HeldStep {
  Vector6 x = Vector6::Zero();
  Matrix6 H = Matrix6::Zero();
  std::vector<Vector6> directions;  ///< unit
};

/// Along those directions that texture holds with a residual of `sigma`; the others stay.
HeldStep step_along(const Sliding& sliding, const TextureSums& sums, double sigma, const TextureConfig& config) {
  const Eigen::Index k = sliding.weak.cols();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Eigen::MatrixXd(sums.H));
  HeldStep out;
  for (Eigen::Index i = 0; i < k; ++i) {
    const double value = eigen.eigenvalues()[i];
    const double variance = value > 0 ? sigma * sigma * config.patch_px / value : 1e9;
    if (variance > config.max_sigma_mm * config.max_sigma_mm) continue;
    if (sliding.changing(eigen.eigenvectors().col(i), config.min_gradient) < config.min_points) continue;
    const Vector6 v = sliding.weak * eigen.eigenvectors().col(i);
    out.x -= v * (eigen.eigenvectors().col(i).dot(sums.g) / value);
    out.H += v * v.transpose() / (variance + config.bias_mm * config.bias_mm);
    out.directions.push_back(v);
  }
  if (const double size = out.x.norm(); size > config.max_step_mm) out.x *= config.max_step_mm / size;
  return out;
}

/// The best along the weak directions from one start.
struct Fit {
  Vector6 x = Vector6::Zero();
  HeldStep step;  ///< at its end
  TextureSums sums;
  double sigma = 0;
};

Pose moved_by(const Sliding& sliding, const Vector6& x, const Pose& T_model_cam) {
  return apply_motion(x, sliding.of.centre, sliding.of.rho_mm, T_model_cam);
}

std::optional<Fit> fit_from(const Sliding& sliding, const Pose& T_model_cam, const Vector6& start,
                            const TextureConfig& config) {
  Fit out;
  out.x = start;
  out.sigma = 10 * config.sigma_floor;  // until the residuals have told theirs
  const std::size_t rounds = 2 * static_cast<std::size_t>(config.rounds);
  for (std::size_t round = 0; round <= rounds; ++round) {
    const Pose now = moved_by(sliding, out.x, T_model_cam);
    out.sums = sum_up(sliding, now, 2 * round < rounds ? 0 : 1, out.sigma);
    if (out.sums.residuals.size() < config.min_points) return std::nullopt;
    out.sigma = std::max(out.sums.scale(), config.sigma_floor);
    out.step = step_along(sliding, out.sums, out.sigma, config);
    if (out.step.directions.empty()) return std::nullopt;
    if (round < rounds) out.x += out.step.x;
  }
  return out;
}

/// Mean square residual beyond that of the fit, once moved by x from it.
double rise(const Sliding& sliding, const Pose& best, const Fit& fit, const Vector6& x) {
  const TextureSums sums = sum_up(sliding, moved_by(sliding, x, best), 1, fit.sigma);
  return sums.residuals.empty() ? 0 : sums.mean_square() - fit.sums.mean_square();
}

/// What is asked for of the rise that the gradients foretell, slipped along a unit direction.
double least_rise(const Sliding& sliding, const Fit& fit, const Vector6& along, const TextureConfig& config) {
  const Eigen::VectorXd q = sliding.weak.transpose() * along;
  const double foretold = q.dot(fit.sums.H * q) / static_cast<double>(fit.sums.residuals.size());
  return config.min_rise * config.slip_mm * config.slip_mm * foretold;
}

/// Noise has gradients too: where only they hold a direction, the greys agree as well a block beside. And what is the
/// same all along a direction agrees wherever one looks.
bool holds_each(const Sliding& sliding, const Pose& best, const Fit& fit, const TextureConfig& config) {
  for (const Vector6& along : fit.step.directions) {
    if (fit.sums.correlation_along(sliding.weak.transpose() * along) < config.min_along) return false;
    const double least = least_rise(sliding, fit, along, config);
    for (const double sign : {1.0, -1.0}) {
      if (rise(sliding, best, fit, sign * config.slip_mm * along) < least) return false;
    }
  }
  return true;
}

/// The rival: what moves with the probe (light on a form that slides on itself, fringes, dust) stands still in the
/// picture. It is refuted where the greys agree less there, by as much as a block beside.
bool moved_in_picture(const Sliding& sliding, const Pose& best, const Fit& fit, const TextureConfig& config) {
  const TextureAlignment& of = sliding.of;
  const Vector6 back = motion_between(best, of.reference.T_model_cam, of.centre, of.rho_mm);
  const Vector6 still = sliding.weak * (sliding.weak.transpose() * back);
  const double away = still.norm();
  return away > config.slip_mm && rise(sliding, best, fit, still) >= least_rise(sliding, fit, still / away, config);
}

std::optional<TextureHold> believed(const Sliding& sliding, const Pose& T_model_cam, const std::optional<Fit>& fit,
                                    const TextureConfig& config) {
  if (!fit || fit->sums.correlation() < config.min_correlation || fit->x.norm() > config.max_move_mm)
    return std::nullopt;
  const Pose best = moved_by(sliding, fit->x, T_model_cam);
  if (!holds_each(sliding, best, *fit, config)) return std::nullopt;
  const bool moved = moved_in_picture(sliding, best, *fit, config);
  if (!moved && !sliding.of.reference.of_surface) return std::nullopt;
  return TextureHold{fit->x, fit->step.H, static_cast<int>(fit->step.directions.size()), fit->sums.correlation(),
                     moved};
}

/// The gradient along the surface of what changes by `du` over the chord `along_u` and by `dv` over `along_v`.
Vec3f along_surface(const Vec3f& along_u, const Vec3f& along_v, float du, float dv) {
  const float uu = along_u.squaredNorm(), uv = along_u.dot(along_v), vv = along_v.squaredNorm();
  const float det = uu * vv - uv * uv;
  return ((vv * du - uv * dv) * along_u + (uu * dv - uv * du) * along_v) / det;
}

}  // namespace

TextureReference texture_reference(const TexturePicture& picture, const Pose& T_model_cam) {
  Map<float> brightness(picture.grey.width(), picture.grey.height());
  const auto unit = static_cast<float>(picture.range / 127);
  for (std::size_t i = 0; i < brightness.size(); ++i) {
    brightness[i] = picture.grey[i] == TexturePicture::kUnknown
                        ? std::numeric_limits<float>::quiet_NaN()
                        : unit * static_cast<float>(static_cast<int>(picture.grey[i]) - 128);
  }
  Map<float> fine = smoothed(brightness);
  Map<float> blurred = fine;
  for (int pass = 0; pass < 4; ++pass) blurred = smoothed(blurred);
  return {T_model_cam, picture.step, {std::move(blurred), std::move(fine)}, false};
}

TexturePoints texture_points(const SurfacePatch& patch, const TextureReference& own, const TextureConfig& config) {
  const auto& [blurred, fine] = own.brightness;
  TexturePoints out;
  const auto point = [&](int i, int j) { return block_point(patch, own.step, i, j); };
  for (int j = 1; j + 1 < fine.height(); ++j) {
    for (int i = 1; i + 1 < fine.width(); ++i) {
      const Vec3f along_u = point(i + 1, j) - point(i - 1, j), along_v = point(i, j + 1) - point(i, j - 1);
      const float du = fine(i + 1, j) - fine(i - 1, j), dv = fine(i, j + 1) - fine(i, j - 1);
      const float gradient = std::hypot(du / along_u.norm(), dv / along_v.norm());
      if (!(gradient >= static_cast<float>(config.min_gradient)) || !std::isfinite(point(i, j).x()) ||
          !std::isfinite(blurred(i, j))) {
        continue;
      }
      out.p.push_back(point(i, j));
      out.brightness.push_back({blurred(i, j), fine(i, j)});
      out.gradient.push_back(along_surface(along_u, along_v, du, dv));
    }
  }
  return out;
}

WeakDirections weak_directions(const NormalSystem& system, double weak_eigenvalue) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(system.H / system.weight);
  Eigen::Index weak = 0;
  while (weak < 6 && eigen.eigenvalues()[weak] < weak_eigenvalue) ++weak;
  return eigen.eigenvectors().leftCols(weak);
}

std::optional<TextureHold> hold_by_texture(const TextureAlignment& of, const Pose& T_model_cam,
                                           const WeakDirections& weak, const TextureConfig& config) {
  if (weak.cols() == 0 || of.points.p.size() < config.min_points) return std::nullopt;
  const Sliding sliding = points_that_slide(of, T_model_cam, weak, config.min_gradient);
  if (sliding.points.p.size() < config.min_points) return std::nullopt;
  const auto from = [&](const Vector6& start) {
    return believed(sliding, T_model_cam, fit_from(sliding, T_model_cam, start, config), config);
  };
  if (auto near = from(Vector6::Zero())) return near;
  std::optional<TextureHold> best;
  for (const Vector6& start : texture_candidates(sliding, T_model_cam, config)) {
    auto found = from(start);
    if (found && (!best || found->correlation > best->correlation)) best = std::move(found);
  }
  return best;
}

}  // namespace enamel::pipeline
