#include "pipeline/algo/icp/reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/lens.hpp"

namespace enamel::algo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

bool close(const Vec3f& a, const Vec3f& b, float jump2) { return (a - b).squaredNorm() < jump2; }

/// One direction of a box sum with zeros beyond the border.
void box_sum(const Map<Vec3f>& in, int radius, bool along_u, Map<Vec3f>& out) {
  const int limit = along_u ? in.width() : in.height();
  for (int v = 0; v < in.height(); ++v) {
    for (int u = 0; u < in.width(); ++u) {
      const int centre = along_u ? u : v;
      Vec3f sum = Vec3f::Zero();
      for (int k = std::max(0, centre - radius); k <= std::min(limit - 1, centre + radius); ++k) {
        sum += along_u ? in(k, v) : in(u, k);
      }
      out(u, v) = sum;
    }
  }
}

/// Sum of unit normals over the window and their number (x of the second map).
void window_sums(const Map<Vec3f>& normals, int radius, Map<Vec3f>& sums, Map<Vec3f>& counts) {
  Map<Vec3f> known(normals.width(), normals.height(), Vec3f::Zero());
  Map<Vec3f> ones(normals.width(), normals.height(), Vec3f::Zero());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (!std::isfinite(normals[i].x())) continue;
    known[i] = normals[i];
    ones[i].x() = 1;
  }
  Map<Vec3f> rows(normals.width(), normals.height(), Vec3f::Zero());
  sums = rows;
  counts = rows;
  box_sum(known, radius, true, rows);
  box_sum(rows, radius, false, sums);
  box_sum(ones, radius, true, rows);
  box_sum(rows, radius, false, counts);
}

}  // namespace

Reference::Reference(const ModelView& view, const ReferenceConfig& config) : T_model_cam_(view.T_model_cam) {
  if (view.empty || view.points.empty() || view.stride < 1) return;
  const int step = std::max(1, config.step_px / view.stride);
  const int width = (view.points.width() + step - 1) / step;
  const int height = (view.points.height() + step - 1) / step;
  scale_ = 1.0F / static_cast<float>(view.stride * step);
  Map<Vec3f> points(width, height, Vec3f::Constant(kNan));
  Map<Vec3f> normals(width, height, Vec3f::Constant(kNan));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      points(u, v) = view.points(u * step, v * step);
      normals(u, v) = view.normals(u * step, v * step);
    }
  }
  Map<Vec3f> sums;
  Map<Vec3f> counts;
  window_sums(normals, config.normal_radius, sums, counts);
  points_ = Map<Vec3f>(width, height, Vec3f::Constant(kNan));
  normals_ = points_;
  const auto jump2 = static_cast<float>(config.edge_jump_mm * config.edge_jump_mm);
  const auto coherence = static_cast<float>(config.min_coherence);
  for (int v = 1; v + 1 < height; ++v) {
    for (int u = 1; u + 1 < width; ++u) {
      const Vec3f& p = points(u, v);
      const bool inside = close(points(u - 1, v), p, jump2) && close(points(u + 1, v), p, jump2) &&
                          close(points(u, v - 1), p, jump2) && close(points(u, v + 1), p, jump2);
      const float length = sums(u, v).norm();
      if (!inside || !std::isfinite(normals(u, v).x()) || !(length > coherence * counts(u, v).x())) continue;
      points_(u, v) = p;
      normals_(u, v) = sums(u, v) / length;
      ++usable_px_;
    }
  }
}

ModelView view_from_patch(const SurfacePatch& patch, const Pose& T_model_cam, const calib::LensValues& lens,
                          int stride) {
  ModelView view;
  view.T_model_cam = T_model_cam;
  view.stride = stride;
  const int width = (patch.points.width() + stride - 1) / stride;
  const int height = (patch.points.height() + stride - 1) / stride;
  view.points = Map<Vec3f>(width, height, Vec3f::Constant(kNan));
  view.normals = view.points;
  const Eigen::Matrix3f R = T_model_cam.linear().cast<float>();
  const Vec3f t = T_model_cam.translation().cast<float>();
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      // The patch lies in the lens's picture, the view in the ideal one.
      const auto px = calib::project(lens, {(i * stride - lens.cx) / lens.fx, (j * stride - lens.cy) / lens.fy});
      const int u = static_cast<int>(std::floor(px.x + 0.5));
      const int v = static_cast<int>(std::floor(px.y + 0.5));
      if (!patch.points.contains(u, v)) continue;
      const Vec3f& p = patch.points(u, v);
      const Vec3f& n = patch.normals(u, v);
      if (!std::isfinite(p.x()) || !std::isfinite(n.x())) continue;
      view.points(i, j) = R * p + t;
      view.normals(i, j) = R * n;
      view.empty = false;
    }
  }
  return view;
}

}  // namespace enamel::algo
