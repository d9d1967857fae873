#include "pipeline/register/icp/texture_term.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/lens.hpp"

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

/// A camera-frame point in a picture: brightness there, and how it changes with the point.
struct Look {
  float brightness = 0;
  Vec3d gradient = Vec3d::Zero();  ///< a mm, camera frame
};

std::optional<Look> look_at(const Map<float>& picture, int step, const calib::LensValues& lens, const Vec3d& p) {
  if (!(p.z() > 1)) return std::nullopt;
  const calib::PlanePoint px = calib::project(lens, {p.x() / p.z(), p.y() / p.z()});
  const double half = 0.5 * (step - 1);
  const double u = (px.x - half) / step, v = (px.y - half) / step;
  const int u0 = static_cast<int>(std::floor(u)), v0 = static_cast<int>(std::floor(v));
  if (!picture.contains(u0, v0) || !picture.contains(u0 + 1, v0 + 1)) return std::nullopt;
  const auto a = static_cast<float>(u - u0), b = static_cast<float>(v - v0);
  const float p00 = picture(u0, v0), p10 = picture(u0 + 1, v0), p01 = picture(u0, v0 + 1),
              p11 = picture(u0 + 1, v0 + 1);
  Look out;
  // NaN where one of the four is unknown.
  out.brightness = (1 - b) * ((1 - a) * p00 + a * p10) + b * ((1 - a) * p01 + a * p11);
  const double along_u = static_cast<double>((1 - b) * (p10 - p00) + b * (p11 - p01)) * lens.fx / step;
  const double along_v = static_cast<double>((1 - a) * (p01 - p00) + a * (p11 - p10)) * lens.fy / step;
  out.gradient = Vec3d(along_u, along_v, -(along_u * p.x() + along_v * p.y()) / p.z()) / p.z();
  return out;
}

/// The sums of one round, along the weak directions alone.
struct TextureSums {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6> H;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> g;
  std::vector<float> residuals;
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;  ///< of both greys, for their correlation
  [[nodiscard]] double mean_square() const {
    double sum = 0;
    for (const float e : residuals) sum += static_cast<double>(e) * static_cast<double>(e);
    return sum / static_cast<double>(residuals.size());
  }
  [[nodiscard]] double correlation() const {
    const auto n = static_cast<double>(residuals.size());
    const double va = aa - a * a / n, vb = bb - b * b / n;
    return va > 0 && vb > 0 ? (ab - a * b / n) / std::sqrt(va * vb) : 0;
  }
  /// Robust standard deviation of the residuals.
  [[nodiscard]] double scale() {
    if (residuals.empty()) return 0;
    const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
    std::nth_element(residuals.begin(), middle, residuals.end());
    return 1.4826 * static_cast<double>(*middle);
  }
};

/// What texture holds, and where it would move that.
struct HeldStep {
  Vector6 x = Vector6::Zero();
  Matrix6 H = Matrix6::Zero();
  std::vector<Vector6> directions;  ///< unit
  std::vector<double> curvature;    ///< of half the squared residuals, along each
};

TextureSums sum_up(const TextureAlignment& of, const Pose& T_model_cam, const WeakDirections& weak, std::size_t level,
                   double sigma) {
  const Eigen::Index k = weak.cols();
  TextureSums out;
  out.H.setZero(k, k);
  out.g.setZero(k);
  const Pose T_ref_model = of.reference.T_model_cam.inverse();
  const Eigen::Matrix3d R_model_ref = of.reference.T_model_cam.linear();
  for (std::size_t n = 0; n < of.points.p.size(); ++n) {
    const Vec3d p = T_model_cam * of.points.p[n].cast<double>();
    const auto look = look_at(of.reference.brightness[level], of.reference.step, of.lens, T_ref_model * p);
    if (!look || !std::isfinite(look->brightness)) continue;
    const float own = of.points.brightness[n][level];
    const auto e = static_cast<double>(look->brightness - own);
    const Vec3d gradient = R_model_ref * look->gradient;
    Vector6 J;
    J << (p - of.centre).cross(gradient) / of.rho_mm, gradient;
    const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> along = weak.transpose() * J;
    const double r = e / (2 * sigma);
    const double w = 1 / ((1 + r * r) * (1 + r * r));
    out.H += w * along * along.transpose();
    out.g += w * e * along;
    out.residuals.push_back(static_cast<float>(std::abs(e)));
    const auto seen = static_cast<double>(look->brightness), had = static_cast<double>(own);
    out.a += seen, out.b += had, out.aa += seen * seen, out.bb += had * had, out.ab += seen * had;
  }
  return out;
}

/// Along those directions that texture holds with a residual of `sigma`; the others stay.
HeldStep step_along(const TextureSums& sums, const WeakDirections& weak, double sigma, const TextureConfig& config) {
  const Eigen::Index k = weak.cols();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Eigen::MatrixXd(sums.H));
  HeldStep out;
  for (Eigen::Index i = 0; i < k; ++i) {
    const double value = eigen.eigenvalues()[i];
    const double variance = value > 0 ? sigma * sigma * config.patch_px / value : 1e9;
    if (variance > config.max_sigma_mm * config.max_sigma_mm) continue;
    const Vector6 v = weak * eigen.eigenvectors().col(i);
    out.x -= v * (eigen.eigenvectors().col(i).dot(sums.g) / value);
    out.H += v * v.transpose() / (variance + config.bias_mm * config.bias_mm);
    out.directions.push_back(v);
    out.curvature.push_back(value);
  }
  if (const double size = out.x.norm(); size > config.max_step_mm) out.x *= config.max_step_mm / size;
  return out;
}

/// Noise has gradients too: where only they hold a direction, the greys agree as well a block beside.
bool rises_beside(const TextureAlignment& of, const Pose& best, const HeldStep& held, const WeakDirections& weak,
                  const TextureConfig& config, double sigma) {
  const double here = sum_up(of, best, weak, 1, sigma).mean_square();
  for (std::size_t k = 0; k < held.directions.size(); ++k) {
    for (const double sign : {1.0, -1.0}) {
      const Pose beside = apply_motion(sign * config.slip_mm * held.directions[k], of.centre, of.rho_mm, best);
      const TextureSums sums = sum_up(of, beside, weak, 1, sigma);
      const double foretold =
          config.slip_mm * config.slip_mm * held.curvature[k] / static_cast<double>(sums.residuals.size());
      if (sums.mean_square() - here < config.min_rise * foretold) return false;
    }
  }
  return true;
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
  return {T_model_cam, picture.step, {std::move(blurred), std::move(fine)}};
}

TexturePoints texture_points(const SurfacePatch& patch, const TextureReference& own, const TextureConfig& config) {
  const auto& [blurred, fine] = own.brightness;
  TexturePoints out;
  const auto point = [&](int i, int j) { return block_point(patch, own.step, i, j); };
  for (int j = 1; j + 1 < fine.height(); ++j) {
    for (int i = 1; i + 1 < fine.width(); ++i) {
      const float wide = (point(i + 1, j) - point(i - 1, j)).norm(), high = (point(i, j + 1) - point(i, j - 1)).norm();
      const float gradient =
          std::hypot((fine(i + 1, j) - fine(i - 1, j)) / wide, (fine(i, j + 1) - fine(i, j - 1)) / high);
      if (!(gradient >= static_cast<float>(config.min_gradient)) || !std::isfinite(point(i, j).x()) ||
          !std::isfinite(blurred(i, j))) {
        continue;
      }
      out.p.push_back(point(i, j));
      out.brightness.push_back({blurred(i, j), fine(i, j)});
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
  TextureHold out;
  HeldStep step;
  double sigma = 10 * config.sigma_floor;  // until the residuals have told theirs
  const std::size_t rounds = 2 * static_cast<std::size_t>(config.rounds);
  for (std::size_t round = 0; round <= rounds; ++round) {
    const Pose now = apply_motion(out.x, of.centre, of.rho_mm, T_model_cam);
    TextureSums sums = sum_up(of, now, weak, 2 * round < rounds ? 0 : 1, sigma);
    if (sums.residuals.size() < config.min_points) return std::nullopt;
    sigma = std::max(sums.scale(), config.sigma_floor);
    step = step_along(sums, weak, sigma, config);
    if (step.directions.empty()) return std::nullopt;
    out.correlation = sums.correlation();
    if (round < rounds) out.x += step.x;
  }
  out.held = static_cast<int>(step.directions.size());
  out.H = step.H;
  const Pose best = apply_motion(out.x, of.centre, of.rho_mm, T_model_cam);
  const bool agrees = out.correlation >= config.min_correlation && out.x.norm() <= config.max_move_mm;
  if (!agrees || !rises_beside(of, best, step, weak, config, sigma)) return std::nullopt;
  return out;
}

}  // namespace enamel::pipeline
