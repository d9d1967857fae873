#include "calib/guide/pose_check.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/solve/measure.hpp"
#include "calib/target/homography.hpp"

namespace enamel::calib {
namespace {

constexpr double kDegPerRad = 180 / std::numbers::pi;
constexpr double kMinTilt_deg = 12, kMaxTilt_deg = 42;  // 15 to 35 are asked for
constexpr double kSaturatedLevel = 0.98;                // of full scale
constexpr double kSameShift_px = 25, kSameTilt_deg = 8, kSameDepth_mm = 1.5;

double saturated_share(const Map<float>& white, double saturation_dn) {
  std::size_t full = 0;
  for (const float p : white.pixels()) full += static_cast<double>(p) >= kSaturatedLevel * saturation_dn ? 1U : 0U;
  return static_cast<double>(full) / static_cast<double>(std::max<std::size_t>(1, white.size()));
}

Eigen::Vector2d middle(const SeenPose& pose) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& p : pose.dots_px) sum += p;
  return sum / static_cast<double>(std::max<std::size_t>(1, pose.dots_px.size()));
}

/// Lean of one target's normal against another's, degrees.
double lean(const SeenPose& a, const SeenPose& b) {
  const auto vector = [](const SeenPose& p) {
    return Eigen::Vector2d(p.tilt_deg * std::cos(p.azimuth_deg / kDegPerRad),
                           p.tilt_deg * std::sin(p.azimuth_deg / kDegPerRad));
  };
  return (vector(a) - vector(b)).norm();
}

bool is_same(const SeenPose& a, const SeenPose& b) {
  return (middle(a) - middle(b)).norm() < kSameShift_px && std::abs(a.depth_mm - b.depth_mm) < kSameDepth_mm &&
         lean(a, b) < kSameTilt_deg;
}

}  // namespace

/// From the homography of the design by the nominal camera without distortion: H = K [r1 r2 t] up to scale.
SeenPose PoseChecker::stand(const PoseView& view) const {
  SeenPose seen;
  std::vector<Eigen::Vector2d> design;
  for (const DotView& dot : view.dots) {
    design.emplace_back(target_.place(dot.dot).head<2>());
    seen.dots_px.push_back(dot.camera_px);
  }
  seen.blur_px = view.blur_px;
  const auto h = fit_homography(design, seen.dots_px);
  if (!h) return seen;
  const LensValues& c = nominal_.camera;
  Eigen::Matrix3d k;
  k << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1;
  Eigen::Matrix3d m = k.inverse() * *h;
  m *= 2 / (m.col(0).norm() + m.col(1).norm());
  if (m(2, 2) < 0) m = -m;
  Vec3d normal = m.col(0).cross(m.col(1)).normalized();
  if (normal.dot(m.col(2)) > 0) normal = -normal;  // towards the camera
  const Vec3d sight = -m.col(2).normalized();
  const Vec3d aside = normal - normal.dot(sight) * sight;
  seen.depth_mm = m(2, 2);
  seen.tilt_deg = kDegPerRad * std::acos(std::clamp(normal.dot(sight), -1.0, 1.0));
  seen.azimuth_deg = kDegPerRad * std::atan2(aside.y(), aside.x());
  return seen;
}

PoseCheck PoseChecker::check(const PoseFrames& frames, const std::vector<SeenPose>& earlier) {
  PoseCheck out;
  if (!edges_) {
    if (const auto chosen = choose_edge_model(frames, target_, noise_)) edges_ = *chosen;
  }
  const auto view =
      measure_pose(frames, target_, noise_, saturation_dn_, {nominal_.projector.width, nominal_.projector.height},
                   edges_.value_or(EdgeModel::kLensThenPixel));
  if (!view) {
    out.reasons.push_back(std::string(describe(view.error().code).text) + ": " + view.error().detail);
    return out;
  }
  out.seen = stand(*view);
  out.seen.saturated = saturated_share(frames.white, saturation_dn_);
  const SeenPose& seen = out.seen;
  if (nominal_.depth_range &&
      !(seen.depth_mm > nominal_.depth_range->near_mm && seen.depth_mm < nominal_.depth_range->far_mm)) {
    out.reasons.push_back(fmt::format("at {:.1f} mm, outside the depth range {} to {} mm: {}", seen.depth_mm,
                                      nominal_.depth_range->near_mm, nominal_.depth_range->far_mm,
                                      seen.depth_mm < nominal_.depth_range->near_mm ? "move away" : "come closer"));
  }
  if (seen.tilt_deg < kMinTilt_deg)
    out.reasons.push_back(fmt::format("tilted by {:.0f} degrees only: tilt it by 15 to 35", seen.tilt_deg));
  if (seen.tilt_deg > kMaxTilt_deg)
    out.reasons.push_back(fmt::format("tilted by {:.0f} degrees: tilt it by 15 to 35", seen.tilt_deg));
  for (std::size_t i = 0; i < earlier.size(); ++i) {
    if (!is_same(seen, earlier[i])) continue;
    out.reasons.push_back(fmt::format("much like pose {:02}: move it, or tilt it to another side", i));
    break;
  }
  return out;
}

}  // namespace enamel::calib
