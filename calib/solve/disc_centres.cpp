#include "calib/solve/disc_centres.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/model/lens.hpp"
#include "calib/solve/disc_bias.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr double kGrossSigmas = 4;
constexpr std::size_t kMinDiscSamples = 20;

/// Camera pixel -> projector pixel by way of a dot's plane.
class PlaneMap {
 public:
  PlaneMap(const RigState& state, const Pose& T_cam_target, const Vec3d& place)
      : state_(state), normal_(T_cam_target.linear().col(2)), offset_(normal_.dot(T_cam_target * place)) {}

  [[nodiscard]] Vector2d operator()(const Vector2d& px) const {
    const PlanePoint ray = undistort(state_.camera, {px.x(), px.y()});
    const Vec3d r(ray.x, ray.y, 1);
    const Vec3d p = state_.T_proj_cam * Vec3d(r * (offset_ / normal_.dot(r)));
    const PlanePoint q = project(state_.projector, {p.x() / p.z(), p.y() / p.z()});
    return {q.x, q.y};
  }

 private:
  const RigState& state_;
  Vec3d normal_;
  double offset_;
};

struct Mean {
  double value = 0, variance = 0;
};

/// Weighted mean of one axis of the residuals; its variance grows with the misfit.
std::optional<Mean> robust_mean(const std::vector<ProjectorSample>& samples, const std::vector<Vector2d>& residuals,
                                int axis) {
  double limit = std::numeric_limits<double>::max();
  Mean mean;
  for (int round = 0; round < 2; ++round) {
    double sum = 0, weight = 0;
    std::size_t n = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double w = 1 / samples[i].variance_px2[axis];
      if (w * std::pow(residuals[i][axis] - mean.value, 2) > limit) continue;
      sum += w * residuals[i][axis];
      weight += w;
      ++n;
    }
    if (n < kMinDiscSamples) return {};
    mean.value = sum / weight;
    double chi2 = 0;
    std::vector<double> each;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double c = std::pow(residuals[i][axis] - mean.value, 2) / samples[i].variance_px2[axis];
      each.push_back(c);
      chi2 += c <= limit ? c : 0;
    }
    mean.variance = std::max(1.0, chi2 / static_cast<double>(n - 1)) / weight;
    std::nth_element(each.begin(), each.begin() + static_cast<std::ptrdiff_t>(each.size() / 2), each.end());
    limit = kGrossSigmas * kGrossSigmas * each[each.size() / 2] / 0.455;  // median of chi² with one degree of freedom
  }
  return mean;
}

void refine_projector(DotView& dot, const PlaneMap& predicted) {
  std::vector<Vector2d> residuals;
  residuals.reserve(dot.samples.size());
  for (const ProjectorSample& s : dot.samples) residuals.emplace_back(s.projector_px - predicted(s.camera_px));
  const auto u = robust_mean(dot.samples, residuals, 0), v = robust_mean(dot.samples, residuals, 1);
  if (!u || !v) return;
  constexpr double kStep_px = 0.5;
  const Vector2d at = dot.camera_px, du(kStep_px, 0), dv(0, kStep_px);
  dot.map.projector_px = predicted(at) + Vector2d(u->value, v->value);
  dot.map.variance_px2 = {u->variance, v->variance};
  dot.map.jacobian << (predicted(at + du) - predicted(at - du)) / (2 * kStep_px),
      (predicted(at + dv) - predicted(at - dv)) / (2 * kStep_px);
}

}  // namespace

double refine_centres(std::vector<PoseView>& poses, const TargetDesign& target, const RigState& state) {
  double largest = 0;
  for (std::size_t j = 0; j < poses.size(); ++j) {
    const Pose& T_cam_target = state.T_cam_target[j];
    for (DotView& dot : poses[j].dots) {
      const Vec3d place = target.place(dot.dot) + state.dot_offsets_mm[static_cast<std::size_t>(dot.dot)];
      Vector2d centre = dot.ellipse.centre;  // a chessboard's corner has no extent and no bias
      if (target.radius_mm > 0) centre -= disc_bias(state.camera, T_cam_target, place, target.radius_mm);
      largest = std::max(largest, (centre - dot.camera_px).norm());
      dot.camera_px = centre;
      refine_projector(dot, PlaneMap(state, T_cam_target, place));
    }
  }
  return largest;
}

}  // namespace enamel::calib
