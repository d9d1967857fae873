#include "calib/solve/residual_field.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "calib/solve/plane_cost.hpp"

namespace enamel::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMinPlanes = 5;
constexpr std::size_t kMinPlaneSamples = 100;
constexpr double kGross = 5;        // of a whitened distance's robust sigma
constexpr double kPrior_mm = 0.01;  // of a coefficient, as a depth at the middle of the planes
constexpr std::array<std::array<int, 3>, 5> kSizes{{{3, 3, 1}, {3, 3, 2}, {4, 4, 2}, {5, 5, 2}, {5, 5, 4}}};

/// A sample of a plane, whitened by sigma z.
struct Distance {
  Eigen::Vector2d px{0, 0};
  double inverse_mm = 0;
  double value = 0;       ///< n . X - d - height
  double by_inverse = 0;  ///< d(value) / d(1/z)
  Vec3d by_plane;         ///< d(value) / d(tilt, tilt, distance)
};

using Plane = std::vector<Distance>;

Plane read_plane(const PoseView& pose, const TargetDesign& target, const RigState& state, const Pose& T_cam_target) {
  Plane plane;
  const Vec3d normal = T_cam_target.linear().col(2);
  for (const GroundSample& s : pose.ground) {
    const PlaneCost cost = plane_cost(s, target, state, T_cam_target, 1);
    const Vec3d ray(cost.ray[0], cost.ray[1], 1);
    const double distance = normal.dot(ray * cost.z_mm - T_cam_target.translation()) - cost.height_mm;
    // All but the distance itself is taken where the plane is, not where noise puts the point: a depth that is too
    // large would weigh more than one that is too small, and the field would learn to shrink.
    const double z_mm = plane_depth_mm(T_cam_target, ray, cost.height_mm);
    const Vec3d on_target = T_cam_target.inverse() * (ray * z_mm);
    plane.push_back({s.camera_px, 1 / z_mm, cost.weight_per_mm * distance,
                     -cost.weight_per_mm * normal.dot(ray) * z_mm * z_mm,
                     cost.weight_per_mm * Vec3d(on_target.x(), on_target.y(), 1)});
  }
  return plane;
}

/// Takes the best plane off the values, then drops what is far off it: specks and shadow borders.
void settle_plane(Plane& plane) {
  for (int round = 0; round < 2; ++round) {
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    Vec3d b = Vec3d::Zero();
    for (const Distance& d : plane) {
      h += d.by_plane * d.by_plane.transpose();
      b += d.by_plane * d.value;
    }
    const Vec3d best = h.ldlt().solve(b);
    std::vector<double> size;
    for (Distance& d : plane) {
      d.value -= d.by_plane.dot(best);
      size.push_back(std::abs(d.value));
    }
    const auto half = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
    std::nth_element(size.begin(), half, size.end());
    const double limit = kGross * *half / 0.6745;
    std::erase_if(plane, [&](const Distance& d) { return std::abs(d.value) > limit; });
  }
}

std::vector<Plane> read_planes(const std::vector<PoseView>& poses, const TargetDesign& target, const RigState& state) {
  std::vector<Plane> planes;
  for (std::size_t j = 0; j < poses.size(); ++j) {
    Plane plane = read_plane(poses[j], target, state, state.T_cam_target[j]);
    if (plane.size() >= kMinPlaneSamples) settle_plane(plane);
    if (plane.size() >= kMinPlaneSamples) planes.push_back(std::move(plane));
  }
  return planes;
}

/// The field's variables over what the planes cover; beyond it the field stands still.
CorrectionField empty_field(const std::vector<Plane>& planes, const std::array<int, 3>& terms) {
  CorrectionField f{
      .u_px = {1e9, -1e9}, .v_px = {1e9, -1e9}, .inverse_mm = {1e9, -1e9}, .terms = terms, .coefficients = {}};
  const auto widen = [](std::array<double, 2>& interval, double x) {
    interval = {std::min(interval[0], x), std::max(interval[1], x)};
  };
  for (const Plane& plane : planes) {
    for (const Distance& d : plane) {
      widen(f.u_px, d.px.x());
      widen(f.v_px, d.px.y());
      widen(f.inverse_mm, d.inverse_mm);
    }
  }
  return f;
}

/// Normal equations of one plane for the field's coefficients, its own tilt and distance eliminated, and the sum of
/// squares that is left without a field.
struct Normal {
  MatrixXd h;
  VectorXd b;
  double squares = 0, samples = 0;

  /// Sum of squares with a field.
  [[nodiscard]] double squares_with(const VectorXd& c) const { return squares - 2 * c.dot(b) + c.dot(h * c); }
};

Normal normal_of(const Plane& plane, const CorrectionField& shape) {
  const Eigen::Index terms = static_cast<Eigen::Index>(shape.terms[0]) * shape.terms[1] * shape.terms[2];
  MatrixXd all = MatrixXd::Zero(terms + 4, terms + 4);  // field, plane, value
  VectorXd row(terms + 4);
  std::vector<double> basis;
  for (const Distance& d : plane) {
    correction_basis(shape, d.px.x(), d.px.y(), d.inverse_mm, basis);
    for (Eigen::Index i = 0; i < terms; ++i) row[i] = -d.by_inverse * basis[static_cast<std::size_t>(i)];
    row.segment<3>(terms) = d.by_plane;
    row[terms + 3] = d.value;
    all.selfadjointView<Eigen::Lower>().rankUpdate(row);
  }
  all = all.selfadjointView<Eigen::Lower>();
  const MatrixXd by_plane = all.middleCols(terms, 3), free = all.block(terms, terms, 3, 3);
  const MatrixXd left = all - by_plane * free.ldlt().solve(by_plane.transpose());
  return {left.topLeftCorner(terms, terms), left.col(terms + 3).head(terms), left(terms + 3, terms + 3),
          static_cast<double>(plane.size())};
}

/// Coefficients from all planes but `unseen`; the prior keeps those at zero that no plane shows, among them every
/// projective map.
VectorXd fit(const std::vector<Normal>& normals, std::size_t unseen, double prior_inverse_mm) {
  const Eigen::Index n = normals.front().b.size();
  MatrixXd h = MatrixXd::Identity(n, n) / (prior_inverse_mm * prior_inverse_mm);
  VectorXd b = VectorXd::Zero(n);
  for (std::size_t j = 0; j < normals.size(); ++j) {
    if (j == unseen) continue;
    h += normals[j].h;
    b += normals[j].b;
  }
  return h.ldlt().solve(b);
}

FieldTrial cross_validate(const std::vector<Normal>& normals, const std::array<int, 3>& terms, double prior) {
  FieldTrial trial{.terms = terms, .gains = {}};
  std::vector<double>& gains = trial.gains;
  for (std::size_t j = 0; j < normals.size(); ++j) {
    const Normal& unseen = normals[j];
    gains.push_back((unseen.squares - unseen.squares_with(fit(normals, j, prior))) / unseen.samples);
  }
  const double n = static_cast<double>(gains.size());
  for (const double g : gains) trial.gain += g / n;
  for (const double g : gains) trial.gain_sigma += std::pow(g - trial.gain, 2) / (n * (n - 1));
  trial.gain_sigma = std::sqrt(trial.gain_sigma);
  return trial;
}

}  // namespace

std::vector<double> plane_misfits(const std::vector<PoseView>& poses, const TargetDesign& target,
                                  const RigState& state) {
  std::vector<double> out;
  for (const Plane& plane : read_planes(poses, target, state)) {
    double squares = 0;
    for (const Distance& d : plane) squares += d.value * d.value;
    out.push_back(squares / static_cast<double>(plane.size()));
  }
  return out;
}

FieldChoice choose_field(const std::vector<PoseView>& poses, const TargetDesign& target, const RigState& state) {
  FieldChoice choice;
  const std::vector<Plane> planes = read_planes(poses, target, state);
  if (planes.size() < kMinPlanes) return choice;
  std::vector<CorrectionField> shapes;
  std::vector<std::vector<Normal>> normals;
  double prior = 0;
  for (const auto& terms : kSizes) {
    shapes.push_back(empty_field(planes, terms));
    prior = kPrior_mm * std::pow(0.5 * (shapes.back().inverse_mm[0] + shapes.back().inverse_mm[1]), 2);
    std::vector<Normal> each;
    each.reserve(planes.size());
    for (const Plane& plane : planes) each.push_back(normal_of(plane, shapes.back()));
    choice.trials.push_back(cross_validate(each, terms, prior));
    normals.push_back(std::move(each));
  }
  const auto& trials = choice.trials;
  const auto best =
      std::max_element(trials.begin(), trials.end(), [](const auto& a, const auto& b) { return a.gain < b.gain; });
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const bool helps = trials[k].gain > trials[k].gain_sigma;
    if (!helps || trials[k].gain < best->gain - best->gain_sigma) continue;
    const VectorXd c = fit(normals[k], planes.size(), prior);
    choice.field = shapes[k];
    choice.field->coefficients.assign(c.begin(), c.end());
    choice.taken = k;
    break;
  }
  return choice;
}

}  // namespace enamel::calib
