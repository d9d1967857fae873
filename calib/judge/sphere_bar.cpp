#include "calib/judge/sphere_bar.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "protocol/base/rng.hpp"

namespace enamel::calib {
namespace {

constexpr double kMinRadius_mm = 1, kMaxRadius_mm = 6;
constexpr int kDraws = 1500;
constexpr std::size_t kVoters = 1500;        // points that a draw is tried on
constexpr double kNear_mm = 0.03;            // of a point that votes for a sphere
constexpr std::size_t kMinBallPoints = 500;  // of a sphere
constexpr double kGrossBallSigmas = 4;
constexpr int kFitSteps = 12;
constexpr double kAround_mm = 0.15;  // a found sphere's surroundings, where the next one is not sought
constexpr double kMaxLength_um = 5, kMaxForm_um = 15;
const double kMinBallCosine = std::cos(55 * std::numbers::pi / 180);

struct Ball {
  Vec3d centre;
  double radius_mm = 0;
};

/// The sphere through four points; empty when they lie in a plane or the sphere is no ball of a bar seen from outside.
std::optional<Ball> through(const std::array<Vec3d, 4>& p) {
  Eigen::Matrix3d a;
  Vec3d b;
  for (int i = 0; i < 3; ++i) {
    const Vec3d d = p[static_cast<std::size_t>(i) + 1] - p[0];
    a.row(i) = 2 * d.transpose();
    b[i] = d.squaredNorm();
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(a);
  if (!lu.isInvertible()) return {};
  const Vec3d from_first = lu.solve(b);
  const double radius = from_first.norm();
  if (!(radius > kMinRadius_mm && radius < kMaxRadius_mm)) return {};
  if (from_first.dot(p[0]) < 0) return {};  // the centre lies on the camera's side: a hollow
  return Ball{p[0] + from_first, radius};
}

/// Cosine between the surface's normal and the way to the camera.
double facing(const Ball& ball, const Vec3d& p) {
  return (ball.centre - p).dot(p) / ((ball.centre - p).norm() * p.norm());
}

bool supports(const Ball& ball, const BarPoint& p) {
  return std::abs((p.place - ball.centre).norm() - ball.radius_mm) < std::max(kNear_mm, 2 * p.sigma_mm) &&
         facing(ball, p.place) > kMinBallCosine;
}

/// The ball that most points lie on: random fours of points from one neighbourhood.
std::optional<Ball> find_ball(const std::vector<BarPoint>& points, Rng& rng) {
  if (points.size() < kMinBallPoints) return {};
  const auto any = [&] { return static_cast<std::size_t>(rng.uniform() * static_cast<double>(points.size())); };
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kVoters);
  std::optional<Ball> best;
  std::size_t most = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::array<Vec3d, 4> four{points[any()].place};
    std::size_t found = 1;
    for (int tries = 0; tries < 40 && found < 4; ++tries) {
      const Vec3d& p = points[any()].place;
      const double away = (p - four[0]).norm();
      if (away > 0.7 && away < 3.5) four[found++] = p;
    }
    if (found < 4) continue;
    const auto ball = through(four);
    if (!ball) continue;
    std::size_t votes = 0;
    for (std::size_t i = 0; i < points.size(); i += stride) votes += supports(*ball, points[i]) ? 1U : 0U;
    if (votes <= most) continue;
    most = votes;
    best = ball;
  }
  return best;
}

struct Residual {
  Eigen::Vector4d by;  ///< d(residual) / d(centre, radius), whitened
  double value = 0;    ///< whitened
  double radial_mm = 0;
  const BarPoint* point = nullptr;
};

/// The noise lies along the ray: of the radial distance it is the cosine's share.
std::vector<Residual> residuals_of(const Ball& ball, const std::vector<BarPoint>& points, double limit_mm) {
  std::vector<Residual> out;
  for (const BarPoint& p : points) {
    const Vec3d out_of = p.place - ball.centre;
    const double distance = out_of.norm(), radial = distance - ball.radius_mm, cosine = facing(ball, p.place);
    if (!(std::abs(radial) < limit_mm) || !(cosine > kMinBallCosine)) continue;
    const double weight = 1 / (p.sigma_mm * cosine);
    Residual r{.by = {}, .value = weight * radial, .radial_mm = radial, .point = &p};
    r.by << -weight * out_of / distance, -weight;
    out.push_back(r);
  }
  return out;
}

double robust_sigma(const std::vector<Residual>& residuals) {
  std::vector<double> size;
  size.reserve(residuals.size());
  for (const Residual& r : residuals) size.push_back(std::abs(r.radial_mm));
  const auto half = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), half, size.end());
  return *half / 0.6745;
}

/// 95th percentile of the means over 5 x 5 pixels with at least half of them.
double form_p95_um(const std::vector<Residual>& residuals) {
  constexpr int kBlock_px = 5, kMinCount = 13;
  std::map<std::pair<int, int>, std::pair<double, int>> blocks;
  for (const Residual& r : residuals) {
    auto& [sum, count] = blocks[{r.point->u / kBlock_px, r.point->v / kBlock_px}];
    sum += r.radial_mm;
    ++count;
  }
  std::vector<double> means;
  for (const auto& [place, block] : blocks)
    if (block.second >= kMinCount) means.push_back(1e3 * std::abs(block.first / block.second));
  if (means.empty()) return 0;
  const auto p95 = means.begin() + static_cast<std::ptrdiff_t>(means.size() * 95 / 100);
  std::nth_element(means.begin(), p95, means.end());
  return *p95;
}

std::optional<SphereFit> fit_ball(Ball ball, const std::vector<BarPoint>& points) {
  double limit_mm = 3 * kNear_mm;
  SphereFit fit;
  for (int step = 0; step < kFitSteps; ++step) {
    const auto residuals = residuals_of(ball, points, limit_mm);
    if (residuals.size() < kMinBallPoints) return {};
    Eigen::Matrix4d h = Eigen::Matrix4d::Zero();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    double chi2 = 0, squares = 0;
    for (const Residual& r : residuals) {
      h += r.by * r.by.transpose();
      b -= r.by * r.value;
      chi2 += r.value * r.value;
      squares += r.radial_mm * r.radial_mm;
    }
    const double n = static_cast<double>(residuals.size());
    const Eigen::Vector4d move = h.ldlt().solve(b);
    ball.centre += move.head<3>();
    ball.radius_mm += move[3];
    limit_mm = kGrossBallSigmas * robust_sigma(residuals);
    fit = {.centre = ball.centre,
           .radius_mm = ball.radius_mm,
           .covariance = h.inverse() * std::max(1.0, chi2 / (n - 4)),
           .points = residuals.size(),
           .rms_um = 1e3 * std::sqrt(squares / n),
           .form_p95_um = form_p95_um(residuals)};
  }
  return fit;
}

}  // namespace

Result<BarCheck> check_bar(std::vector<BarPoint> points) {
  Rng rng(1, 0, 2);
  BarCheck check;
  for (SphereFit& sphere : check.spheres) {
    const auto ball = find_ball(points, rng);
    const auto fit = ball ? fit_ball(*ball, points) : std::nullopt;
    if (!fit) {
      return fail(ErrorCode::kCalibrationPoses,
                  "no two spheres of 1 to 6 mm radius are in view; show both to camera and projector");
    }
    sphere = *fit;
    std::erase_if(points,
                  [&](const BarPoint& p) { return (p.place - fit->centre).norm() < fit->radius_mm + kAround_mm; });
  }
  if (check.spheres[0].radius_mm > check.spheres[1].radius_mm) std::swap(check.spheres[0], check.spheres[1]);
  const Vec3d way = check.spheres[1].centre - check.spheres[0].centre;
  check.distance_mm = way.norm();
  const Vec3d along = way / check.distance_mm;
  double variance = 0;
  for (const SphereFit& s : check.spheres) variance += along.dot(s.covariance.topLeftCorner<3, 3>() * along);
  check.distance_sigma_mm = std::sqrt(variance);
  return check;
}

std::vector<std::string> judge_bar(const BarCheck& check, const BarDesign& design) {
  std::vector<std::string> reasons;
  const auto length = [&](const std::string& what, double measured_mm, double sigma_mm, double true_mm) {
    const double off_um = 1e3 * (measured_mm - true_mm);
    if (std::abs(off_um) - 2e3 * sigma_mm > kMaxLength_um) {
      reasons.push_back(
          fmt::format("{} is off by {:+.1f} +- {:.1f} um, limit {:.0f} um: the scale or the lens is not what "
                      "it was; calibrate again",
                      what, off_um, 1e3 * sigma_mm, kMaxLength_um));
    }
  };
  for (std::size_t i = 0; i < 2; ++i) {
    const SphereFit& s = check.spheres[i];
    const std::string name = i == 0 ? "the smaller sphere" : "the larger sphere";
    length("the diameter of " + name, s.diameter_mm(), s.diameter_sigma_mm(), design.diameter_mm[i]);
    if (s.form_p95_um > kMaxForm_um) {
      reasons.push_back(
          fmt::format("{} is out of round by {:.1f} um (95 %), limit {:.0f} um: clean the bar, more light", name,
                      s.form_p95_um, kMaxForm_um));
    }
  }
  length("the distance of the spheres", check.distance_mm, check.distance_sigma_mm, design.distance_mm);
  return reasons;
}

}  // namespace enamel::calib
