#include "calib/judge/drift_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace enamel::calib {
namespace {

constexpr float kMaxStep_mm = 0.15F;  // between neighbouring pixels, 28 um apart: steeper is a silhouette
constexpr float kMinCosine = 0.5F;

SurfaceCell cell_at(const SurfacePatch& patch, int u0, int v0) {
  SurfaceCell cell;
  Vec3f point = Vec3f::Zero(), normal = Vec3f::Zero();
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0, variance = 0;
  for (int v = v0; v < v0 + kDriftCell_px; ++v) {
    for (int u = u0; u < u0 + kDriftCell_px; ++u) {
      const std::size_t i = patch.depth_mm.index(u, v);
      if (!(patch.depth_mm[i] > 0) || !patch.normals[i].allFinite()) return cell;
      nearest = std::min(nearest, patch.depth_mm[i]);
      farthest = std::max(farthest, patch.depth_mm[i]);
      point += patch.points[i];
      normal += patch.normals[i];
      variance += patch.sigma_mm[i] * patch.sigma_mm[i];
    }
  }
  constexpr float kPixels = kDriftCell_px * kDriftCell_px;
  point /= kPixels;
  normal.normalize();
  if (farthest - nearest > kMaxStep_mm || -normal.dot(point.normalized()) < kMinCosine) return cell;
  return {point, normal, std::sqrt(variance) / kPixels, 0};
}

}  // namespace

void fill_depths_around(DriftView& view) {
  constexpr std::array<std::array<int, 2>, 4> kAround{{{-2, 0}, {2, 0}, {0, -2}, {0, 2}}};
  const auto depth_at = [&](int u, int v) {
    return view.cells.contains(u, v) ? view.cells(u, v).point.z() : std::numeric_limits<float>::quiet_NaN();
  };
  for (int v = 0; v < view.cells.height(); ++v) {
    for (int u = 0; u < view.cells.width(); ++u) {
      float sum = 0, count = 0;
      for (const auto& [du, dv] : kAround) {
        const float depth = depth_at(u + du, v + dv);
        if (std::isnan(depth) || std::isnan(depth_at(u - du, v - dv))) continue;  // pairs: a slope cancels
        sum += depth;
        count += 1;
      }
      view.cells(u, v).depth_around_mm = count > 0 ? sum / count : std::numeric_limits<float>::quiet_NaN();
    }
  }
}

DriftView drift_view(const SurfacePatch& patch, const Pose& T_model_cam) {
  DriftView view{{patch.depth_mm.width() / kDriftCell_px, patch.depth_mm.height() / kDriftCell_px}, T_model_cam};
  for (int v = 0; v < view.cells.height(); ++v) {
    for (int u = 0; u < view.cells.width(); ++u)
      view.cells(u, v) = cell_at(patch, u * kDriftCell_px, v * kDriftCell_px);
  }
  fill_depths_around(view);
  return view;
}

}  // namespace enamel::calib
