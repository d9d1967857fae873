#include "calib/solve/sanity.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/model/lens.hpp"

namespace enamel::calib {
namespace {

constexpr double kMinTurn_deg = 10;
constexpr double kMaxBaselineShare = 0.08;
constexpr double kDepthSlack = 3;  // beyond a third or three times the range no lens tolerance explains it

/// Depth at which the target would have to be for its dots to lie as far apart as they are seen, mm.
double implied_depth_mm(const PoseView& view, const TargetDesign& target, const LensValues& camera) {
  std::vector<double> depths;
  for (const DotView& p : view.dots) {
    for (const DotView& q : view.dots) {
      const GridIndex a = target.grid(p.dot), b = target.grid(q.dot);
      if (std::abs(a.col - b.col) + std::abs(a.row - b.row) != 1) continue;
      depths.push_back(camera.fx * target.pitch_mm / (p.camera_px - q.camera_px).norm());
    }
  }
  if (depths.empty()) return 0;
  std::sort(depths.begin(), depths.end());
  return depths[depths.size() / 10];  // steps across the tilt are the least foreshortened
}

/// Sign of the map camera px -> projector px by the nominal rig at mid-depth: its determinant.
double nominal_determinant(const Rig& rig, double z_mm) {
  const auto at = [&](double u, double v) {
    const PlanePoint p = project_to_projector(rig, undistort(rig.camera, {u, v}), z_mm);
    return Eigen::Vector2d(p.x, p.y);
  };
  const double u = 0.5 * rig.camera.width, v = 0.5 * rig.camera.height;
  Eigen::Matrix2d j;
  j << at(u + 1, v) - at(u, v), at(u, v + 1) - at(u, v);
  return j.determinant();
}

}  // namespace

Result<void> check_views(const std::vector<PoseView>& views, const TargetDesign& target, const Rig& nominal) {
  if (views.size() < kMinPoses) {
    return fail(ErrorCode::kCalibrationPoses,
                fmt::format("{} usable poses, at least {} are needed", views.size(), kMinPoses));
  }
  const DepthRange range = nominal.depth_range.value_or(DepthRange{0, 0});
  std::size_t mirrored = 0;
  for (const PoseView& view : views) {
    const double depth = implied_depth_mm(view, target, nominal.camera);
    if (nominal.depth_range && depth > 0 &&
        (depth > kDepthSlack * range.far_mm || depth < range.near_mm / kDepthSlack)) {
      return fail(ErrorCode::kCalibrationUnits,
                  fmt::format("pitch_mm {} puts the target of pose {} at {:.3g} mm, the rig measures from {} to {} mm",
                              target.pitch_mm, view.name, depth, range.near_mm, range.far_mm));
    }
    const double mid = middle_depth_mm(nominal, depth);
    std::size_t against = 0;
    for (const DotView& dot : view.dots)
      against += dot.map.jacobian.determinant() * nominal_determinant(nominal, mid) < 0 ? 1U : 0U;
    mirrored += 2 * against > view.dots.size() ? 1U : 0U;
  }
  if (2 * mirrored > views.size()) {
    return fail(ErrorCode::kTargetMirrored,
                fmt::format("in {} of {} poses the projector's u falls as the camera's rises", mirrored, views.size()));
  }
  return {};
}

Result<void> check_tilts(const std::vector<Pose>& poses) {
  double widest = 0;
  for (const Pose& p : poses) {
    for (const Pose& q : poses) {
      const double cosine = std::clamp(p.linear().col(2).dot(q.linear().col(2)), -1.0, 1.0);
      widest = std::max(widest, std::acos(cosine) * 180 / std::numbers::pi);
    }
  }
  if (widest >= kMinTurn_deg) return {};
  return fail(
      ErrorCode::kCalibrationPoses,
      fmt::format("all poses are parallel within {:.1f} degrees: focal length and distance cannot be told apart",
                  widest));
}

Result<void> check_baseline(const Pose& T_proj_cam, const TargetDesign& target, const Rig& nominal) {
  const auto& t = nominal.T_proj_cam;
  const double design_mm = std::hypot(t[0][3], t[1][3], t[2][3]), seen_mm = T_proj_cam.translation().norm();
  if (!(design_mm > 0) || std::abs(seen_mm / design_mm - 1) <= kMaxBaselineShare) return {};
  return fail(
      ErrorCode::kCalibrationUnits,
      fmt::format("pitch_mm {} puts camera and projector {:.2f} mm apart, the design says {:.2f}: {:.4g} would fit",
                  target.pitch_mm, seen_mm, design_mm, target.pitch_mm * design_mm / seen_mm));
}

}  // namespace enamel::calib
