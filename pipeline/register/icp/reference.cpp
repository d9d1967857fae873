#include "pipeline/register/icp/reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace enamel::pipeline
