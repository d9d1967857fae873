#include "host/accuracy/balls.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "host/accuracy/figures.hpp"
#include "pipeline/register/map/sphere_votes.hpp"

namespace enamel::host {
namespace {

struct SurfacePoint {
  Vec3d at, normal;
  double area_mm2;
};

/// Vertices with the area that is nearest to each, normals from the triangles: not every file has them.
std::vector<SurfacePoint> points_of(const Mesh& mesh) {
  std::vector<SurfacePoint> out;
  out.reserve(mesh.vertices.size());
  for (const Vec3f& v : mesh.vertices) out.push_back({v.cast<double>(), Vec3d::Zero(), 0});
  for (const auto& t : mesh.triangles) {
    const Vec3d twice = (out[t[1]].at - out[t[0]].at).cross(out[t[2]].at - out[t[0]].at);
    for (const std::uint32_t corner : t) {
      out[corner].normal += twice;
      out[corner].area_mm2 += twice.norm() / 6;
    }
  }
  for (SurfacePoint& p : out) p.normal.normalize();
  return out;
}

struct Ball {
  Vec3d centre;
  double radius;
};

struct OnBall {
  const SurfacePoint* point;
  double off_mm;  ///< outwards
};

std::vector<OnBall> on_ball(const std::vector<SurfacePoint>& near, const Ball& ball, double gate_mm,
                            double min_cosine) {
  std::vector<OnBall> out;
  for (const SurfacePoint& p : near) {
    const Vec3d from = p.at - ball.centre;
    const double distance = from.norm();
    if (std::abs(distance - ball.radius) > gate_mm || p.normal.dot(from) < min_cosine * distance) continue;
    out.push_back({&p, distance - ball.radius});
  }
  return out;
}

/// 1.4826 medians of |d|: the deviation of what is not an outlier.
double robust_sigma(const std::vector<OnBall>& on) {
  std::vector<double> off;
  off.reserve(on.size());
  for (const OnBall& p : on) off.push_back(std::abs(p.off_mm));
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::ranges::nth_element(off, middle);
  constexpr double kOfMedian = 1.4826;
  return kOfMedian * *middle;
}

/// One Gauss-Newton step of centre and radius over the points within `within_mm`.
Ball stepped(const Ball& ball, const std::vector<OnBall>& on, double within_mm) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  for (const OnBall& p : on) {
    if (std::abs(p.off_mm) > within_mm) continue;
    Eigen::Vector4d J;
    J << (p.point->at - ball.centre).normalized(), 1;
    A += J * J.transpose();
    b += p.off_mm * J;
  }
  const Eigen::Vector4d x = A.ldlt().solve(b);
  return {ball.centre + x.head<3>(), ball.radius + x[3]};
}

class Fitter {
 public:
  Fitter(const std::vector<SurfacePoint>& points, double diameter_mm, const BallConfig& config)
      : points_(points),
        config_(config),
        radius_(diameter_mm / 2),
        min_cosine_(std::cos(config.normal_deg * std::numbers::pi / 180)) {}

  [[nodiscard]] std::optional<FittedBall> fit(const Vec3d& start) const {
    std::vector<SurfacePoint> near;
    const double reach = radius_ + kFirstGates * config_.gate_mm + config_.vote_mm;
    for (const SurfacePoint& p : points_)
      if ((p.at - start).squaredNorm() < reach * reach) near.push_back(p);
    Ball ball{start, radius_};
    for (int round = 0; round < config_.rounds; ++round) {
      const double gate = config_.gate_mm * std::max(1.0, kFirstGates / (1 + round));
      const std::vector<OnBall> on = on_ball(near, ball, gate, min_cosine_);
      if (on.size() < kFewest) return std::nullopt;
      const Ball next = stepped(ball, on, config_.trim_sigmas * std::max(robust_sigma(on), kFinest_mm));
      if (!next.centre.allFinite() || (next.centre - start).norm() > radius_) return std::nullopt;
      const double moved = (next.centre - ball.centre).norm();
      ball = next;
      if (round > kFirstGates && moved < kStill_mm) break;
    }
    return judged(ball, near);
  }

 private:
  static constexpr double kFirstGates = 4;  ///< from votes good to a tenth of a mm to the gate
  static constexpr double kFinest_mm = 1e-4, kStill_mm = 1e-7;
  static constexpr std::size_t kFewest = 50;  ///< points; fewer say nothing of roundness

  [[nodiscard]] std::optional<FittedBall> judged(const Ball& ball, const std::vector<SurfacePoint>& near) const {
    const std::vector<OnBall> on = on_ball(near, ball, config_.gate_mm, min_cosine_);
    if (on.size() < kFewest) return std::nullopt;
    const double within = config_.trim_sigmas * std::max(robust_sigma(on), kFinest_mm);
    FittedBall out{.centre = ball.centre, .diameter_mm = 2 * ball.radius, .points = on.size()};
    std::vector<double> off;
    double squares = 0, taken = 0;
    for (const OnBall& p : on) {
      off.push_back(p.off_mm);
      out.share += p.point->area_mm2 / (4 * std::numbers::pi * ball.radius * ball.radius);
      if (std::abs(p.off_mm) > within) continue;
      squares += p.off_mm * p.off_mm;
      taken += 1;
    }
    constexpr double kOfForm = 0.95;
    out.form_mm = range_of(std::move(off), kOfForm);
    out.rms_mm = std::sqrt(squares / std::max(taken, 1.0));
    const bool is_ball = out.share >= config_.min_share && out.form_mm <= config_.form_mm &&
                         std::abs(out.diameter_mm - 2 * radius_) <= config_.diameter_mm;
    return is_ball ? std::optional(out) : std::nullopt;
  }

  const std::vector<SurfacePoint>& points_;
  const BallConfig& config_;
  double radius_, min_cosine_;
};

}  // namespace

std::vector<FittedBall> find_balls(const Mesh& mesh, double diameter_mm, const BallConfig& config) {
  const std::vector<SurfacePoint> points = points_of(mesh);
  const double radius = diameter_mm / 2;
  const std::size_t stride = points.size() / std::max<std::size_t>(config.most_votes, 1) + 1;
  std::vector<Vec3f> votes;
  double area = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    area += points[i].area_mm2;
    if (i % stride == 0 && points[i].normal.allFinite())
      votes.push_back((points[i].at - radius * points[i].normal).cast<float>());
  }
  if (votes.empty() || !(area > 0)) return {};
  // Half of what a ball seen just enough would give: noise of the normals spreads votes.
  const double whole = 4 * std::numbers::pi * radius * radius / area * static_cast<double>(votes.size());
  constexpr int kFewest = 10;
  const int least = std::max(kFewest, static_cast<int>(0.5 * config.min_share * whole));
  const Fitter fitter(points, diameter_mm, config);
  std::vector<FittedBall> out;
  for (const auto& peak :
       pipeline::find_peaks(votes, static_cast<float>(config.vote_mm), static_cast<float>(radius / 2), least)) {
    const auto found = fitter.fit(peak.at.cast<double>());
    if (!found) continue;
    const bool known = std::ranges::any_of(
        out, [&](const FittedBall& other) { return (other.centre - found->centre).norm() < radius; });
    if (!known) out.push_back(*found);
  }
  std::ranges::stable_sort(out, std::ranges::greater{}, &FittedBall::share);
  return out;
}

}  // namespace enamel::host
