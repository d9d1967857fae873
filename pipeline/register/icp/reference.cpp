#include "pipeline/register/icp/reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/lens.hpp"
#include "pipeline/register/icp/pitch.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

bool close(const Vec3f& a, const Vec3f& b, float jump2) { return (a - b).squaredNorm() < jump2; }

/// Sum of unit normals and, last, their number.
using Sum = Eigen::Vector4f;

/// Box sums down the columns, zeros beyond the border. Whole rows at a time: contiguous.
void column_sums(const Map<Sum>& in, int radius, Map<Sum>& out) {
  for (int v = 0; v < in.height(); ++v) {
    for (int k = std::max(0, v - radius); k <= std::min(in.height() - 1, v + radius); ++k) {
      for (int u = 0; u < in.width(); ++u) out(u, v) += in(u, k);
    }
  }
}

void row_sums(const Map<Sum>& in, int radius, Map<Sum>& out) {
  for (int v = 0; v < in.height(); ++v) {
    for (int u = 0; u < in.width(); ++u) {
      Sum sum = Sum::Zero();
      for (int k = std::max(0, u - radius); k <= std::min(in.width() - 1, u + radius); ++k) sum += in(k, v);
      out(u, v) = sum;
    }
  }
}

Map<Sum> window_sums(const Map<Vec3f>& normals, int radius) {
  Map<Sum> known(normals.width(), normals.height(), Sum::Zero());
  Map<Sum> rows(normals.width(), normals.height(), Sum::Zero());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (std::isfinite(normals[i].x())) known[i] << normals[i], 1.0F;
  }
  row_sums(known, radius, rows);
  std::fill(known.pixels().begin(), known.pixels().end(), Sum::Zero());
  column_sums(rows, radius, known);
  return known;
}

}  // namespace

Reference::Reference(const ModelView& view, const ReferenceConfig& config) : T_model_cam_(view.T_model_cam) {
  if (view.empty || view.points.empty() || view.stride < 1) return;
  const double pitch = mean_pitch_mm(view.points);
  if (!(pitch > 0)) return;
  const int step = std::max(1, static_cast<int>(std::lround(config.pitch_mm / pitch)));
  const int radius = std::max(1, static_cast<int>(std::lround(config.normal_radius_mm / (pitch * step))));
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
  const Map<Sum> sums = window_sums(normals, radius);
  pixels_ = Map<Pixel>(width, height, Pixel{Vec3f::Constant(kNan), 0, Vec3f::Constant(kNan), 0});
  const double jump = config.edge_pitches * pitch * step;
  const auto jump2 = static_cast<float>(jump * jump);
  const auto coherence = static_cast<float>(config.min_coherence);
  for (int v = 1; v + 1 < height; ++v) {
    for (int u = 1; u + 1 < width; ++u) {
      const Vec3f& p = points(u, v);
      const bool inside = close(points(u - 1, v), p, jump2) && close(points(u + 1, v), p, jump2) &&
                          close(points(u, v - 1), p, jump2) && close(points(u, v + 1), p, jump2);
      const Vec3f sum = sums(u, v).head<3>();
      const float length = sum.norm();
      if (!inside || !std::isfinite(normals(u, v).x()) || !(length > coherence * sums(u, v).w())) continue;
      pixels_(u, v).point = p;
      pixels_(u, v).normal = sum / length;
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

ModelView carried_into(const Pose& T_other_model, ModelView view) {
  view.T_model_cam = T_other_model * view.T_model_cam;
  const Eigen::Matrix3f R = T_other_model.linear().cast<float>();
  const Vec3f t = T_other_model.translation().cast<float>();
  for (Vec3f& p : view.points.pixels()) p = R * p + t;
  for (Vec3f& n : view.normals.pixels()) n = R * n;
  return view;
}

}  // namespace enamel::pipeline
