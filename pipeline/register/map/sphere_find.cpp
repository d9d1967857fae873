#include "pipeline/register/map/sphere_find.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "pipeline/register/map/sphere_votes.hpp"

namespace enamel::pipeline {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector4d;

struct Ball {
  Vec3d centre;
  double radius;
};

/// Where a ray from the camera first meets the ball, as a share of `direction`, and the cosine of incidence there.
struct Meeting {
  double at, cosine;
};
std::optional<Meeting> meet(const Ball& ball, const Vec3d& direction) {
  const double dd = direction.squaredNorm(), dc = direction.dot(ball.centre);
  const double root2 = dc * dc - dd * (ball.centre.squaredNorm() - ball.radius * ball.radius);
  if (root2 <= 0) return std::nullopt;
  return Meeting{(dc - std::sqrt(root2)) / dd, std::sqrt(root2 / dd) / ball.radius};
}

/// Normal equations of centre and radius over the points of the cap that lie within the gate.
struct CapFit {
  Matrix4d H = Matrix4d::Zero();
  Vector4d g = Vector4d::Zero();
  double chi2 = 0, squares = 0, noise = 0;
  int on = 0, off = 0, cap = 0;  ///< pixels on the ball, elsewhere, and of the whole cap, inside the picture or not
};

class Cap {
 public:
  Cap(const SurfacePatch& patch, const calib::LensValues& lens, double cap_deg)
      : patch_(patch), lens_(lens), min_cosine_(std::cos(cap_deg * std::numbers::pi / 180)) {}

  [[nodiscard]] CapFit weigh(const Ball& ball, double gate_mm) const {
    CapFit fit;
    const double u0 = lens_.cx + lens_.fx * ball.centre.x() / ball.centre.z();
    const double v0 = lens_.cy + lens_.fy * ball.centre.y() / ball.centre.z();
    const double half = 1.1 * std::max(lens_.fx, lens_.fy) * ball.radius / (ball.centre.z() - ball.radius) + 2;
    for (int v = static_cast<int>(v0 - half); v <= v0 + half; ++v) {
      for (int u = static_cast<int>(u0 - half); u <= u0 + half; ++u) add(ball, gate_mm, u, v, fit);
    }
    return fit;
  }

 private:
  void add(const Ball& ball, double gate_mm, int u, int v, CapFit& fit) const {
    const bool inside = u >= 0 && v >= 0 && u < lens_.width && v < lens_.height;
    const std::size_t i = inside ? patch_.depth_mm.index(u, v) : 0;
    const bool measured = inside && std::isfinite(patch_.points[i].x());
    const Vec3d ray = measured ? Vec3d(patch_.points[i].cast<double>())
                               : Vec3d((u - lens_.cx) / lens_.fx, (v - lens_.cy) / lens_.fy, 1);
    const auto met = meet(ball, ray);
    if (!met || met->cosine < min_cosine_) return;
    ++fit.cap;
    if (!measured) return;
    const Vec3d from_centre = ray - ball.centre;
    const double e = from_centre.norm() - ball.radius;
    constexpr double kFinestMm = 1e-4;  // no measurement is surer
    const double sigma =
        std::max(kFinestMm, static_cast<double>(patch_.sigma_mm[i]) * ray.norm() / ray.z() * met->cosine);
    constexpr double kSigmas = 4;  // of noise that still is the ball
    if (!(std::abs(e) <= std::hypot(gate_mm, kSigmas * sigma))) {
      ++fit.off;
      return;
    }
    ++fit.on;
    Vector4d J;
    J << -from_centre.normalized(), -1;
    const double w = 1 / (sigma * sigma);
    fit.H += w * J * J.transpose();
    fit.g += w * e * J;
    fit.chi2 += w * e * e;
    fit.squares += e * e;
    fit.noise += sigma * sigma;
  }

  const SurfacePatch& patch_;
  const calib::LensValues& lens_;
  double min_cosine_;
};

std::vector<Vec3f> votes_of(const SurfacePatch& patch, double radius_mm, int stride_px) {
  std::vector<Vec3f> out;
  const auto radius = static_cast<float>(radius_mm);
  for (int v = 0; v < patch.depth_mm.height(); v += stride_px) {
    for (int u = 0; u < patch.depth_mm.width(); u += stride_px) {
      const std::size_t i = patch.depth_mm.index(u, v);
      if (std::isfinite(patch.points[i].x()) && std::isfinite(patch.normals[i].x()))
        out.push_back(patch.points[i] - radius * patch.normals[i]);
    }
  }
  return out;
}

/// Is all that should be seen of the ball there, and nothing but the ball?
bool is_ball(const CapFit& fit, const FoundSphere& found, double radius_sigma_mm, const SphereConfig& config) {
  if (fit.on < config.min_seen * fit.cap || fit.on < config.min_agree * (fit.on + fit.off)) return false;
  const double beyond2 = (fit.squares - fit.noise) / fit.on;
  if (beyond2 > config.form_mm * config.form_mm) return false;
  constexpr double kSigmas = 4;
  return std::abs(found.radius_off_mm) <= config.radius_mm + kSigmas * radius_sigma_mm;
}

std::optional<FoundSphere> fit_ball(const Cap& cap, Ball ball, const SphereConfig& config) {
  CapFit fit;
  for (int round = 0; round < config.rounds; ++round) {
    const double share = static_cast<double>(round) / std::max(config.rounds - 2, 1);
    const double gate = std::max(config.gate_mm, config.first_gate_mm * (1 - share));
    fit = cap.weigh(ball, gate);
    constexpr int kFewest = 50;  // pixels; what is smaller is not seen well enough to be judged
    if (fit.on < kFewest || round + 1 == config.rounds) break;
    const Vec3d step = fit.H.topLeftCorner<3, 3>().ldlt().solve(-fit.g.head<3>());
    if (!(step.norm() < ball.radius)) return std::nullopt;
    ball.centre += step;
    if (ball.centre.z() <= 2 * ball.radius) return std::nullopt;
  }
  constexpr int kUnknowns = 4;
  if (fit.on <= kUnknowns || fit.on < config.min_seen * fit.cap) return std::nullopt;
  const Matrix3d inverse = Matrix3d(fit.H.topLeftCorner<3, 3>()).inverse();
  const Vec3d cross = fit.H.topRightCorner<3, 1>();
  const double scale = std::max(1.0, fit.chi2 / (fit.on - kUnknowns));
  const double of_radius = fit.H(3, 3) - cross.dot(inverse * cross);
  FoundSphere out;
  out.radius_mm = ball.radius;
  out.centre = ball.centre;
  out.covariance = scale * inverse;
  out.per_radius = -inverse * cross;
  out.radius_off_mm = -(fit.g[3] - cross.dot(inverse * fit.g.head<3>())) / of_radius;
  out.rms_mm = std::sqrt(fit.squares / fit.on);
  out.points = fit.on;
  if (!is_ball(fit, out, std::sqrt(scale / of_radius), config)) return std::nullopt;
  return out;
}

}  // namespace

std::vector<FoundSphere> find_spheres(const SurfacePatch& patch, const calib::LensValues& lens, double radius_mm,
                                      const SphereConfig& config) {
  const std::vector<Vec3f> votes = votes_of(patch, radius_mm, config.vote_stride_px);
  if (votes.empty()) return {};
  double depth = 0;  // about where the balls are: of the mean vote
  for (const Vec3f& p : votes) depth += static_cast<double>(p.z());
  depth /= static_cast<double>(votes.size());
  const double across_px = lens.fx / depth * radius_mm * std::sin(config.cap_deg * std::numbers::pi / 180);
  const double whole = std::numbers::pi * across_px * across_px / (config.vote_stride_px * config.vote_stride_px);
  const auto peaks = find_peaks(votes, static_cast<float>(config.vote_mm), static_cast<float>(radius_mm),
                                std::max(1, static_cast<int>(config.min_vote_share * whole)));
  const Cap cap(patch, lens, config.cap_deg);
  std::vector<FoundSphere> out;
  for (const VotePeak& peak : peaks) {
    const auto found = fit_ball(cap, {peak.at.cast<double>(), radius_mm}, config);
    if (!found) continue;
    const bool known = std::ranges::any_of(
        out, [&](const FoundSphere& other) { return (other.centre - found->centre).norm() < radius_mm; });
    if (!known) out.push_back(*found);
  }
  return out;
}

}  // namespace enamel::pipeline
