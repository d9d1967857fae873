#include "pipeline/register/feature/surface_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/register/feature/bend_rows.hpp"
#include "pipeline/types/pixel_step.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kMinSeen = 0.7F;  // chosen: of the disc; a third hidden already moves its mean by half its radius

struct Element {
  Vec3f point = Vec3f::Zero();
  Vec3f normal = Vec3f::Zero();
  float area_mm2 = 0;
};

/// Mean of a block of pixels; nothing where less than half of it is surface.
Element block_mean(const SurfacePatch& patch, int u0, int v0, int step, float min_cos) {
  Element out;
  int known = 0;
  for (int v = v0; v < v0 + step; ++v) {
    for (int u = u0; u < u0 + step; ++u) {
      const Vec3f& n = patch.normals(u, v);
      const Vec3f& p = patch.points(u, v);
      if (!(n.x() == n.x()) || !(p.x() == p.x())) continue;
      out.point += p;
      out.normal += n;
      ++known;
    }
  }
  if (2 * known < step * step) return {};
  out.point /= static_cast<float>(known);
  const float length = out.normal.norm();
  out.normal /= length;
  const float cosine = -out.normal.dot(out.point) / out.point.norm();
  if (!(cosine > min_cos)) return {};
  // A pixel's solid angle is nearly that of one on the axis: its area grows with depth squared and incidence.
  out.area_mm2 = out.point.z() * out.point.z() / cosine;
  return out;
}

}  // namespace

SurfaceGrid make_surface_grid(const SurfacePatch& patch, double px_per_mm, const GridConfig& config) {
  const int step = pixel_step(config.pitch_mm, px_per_mm);
  const int width = patch.points.width() / step;
  const int height = patch.points.height() / step;
  SurfaceGrid out{Map<Vec3f>(width, height, Vec3f::Zero()), Map<Vec3f>(width, height, Vec3f::Zero()),
                  Map<float>(width, height, 0.0F), static_cast<float>(step / px_per_mm)};
  const auto min_cos = static_cast<float>(std::cos(config.max_incidence_deg * std::numbers::pi / 180));
  double depth2 = 0;
  std::size_t known = 0;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const Element e = block_mean(patch, u * step, v * step, step, min_cos);
      if (!(e.area_mm2 > 0)) continue;
      out.points(u, v) = e.point;
      out.normals(u, v) = e.normal;
      out.area_mm2(u, v) = e.area_mm2;
      depth2 += static_cast<double>(e.point.z()) * static_cast<double>(e.point.z());
      ++known;
    }
  }
  const auto scale =
      known > 0 ? static_cast<float>(out.pitch_mm * out.pitch_mm * static_cast<double>(known) / depth2) : 0.0F;
  for (float& area : out.area_mm2.pixels()) area *= scale;
  return out;
}

Map<float> bending(const SurfaceGrid& grid, double radius_mm) {
  const int width = grid.points.width();
  const int height = grid.points.height();
  Map<float> out(width, height, std::numeric_limits<float>::quiet_NaN());
  const auto radius = static_cast<float>(radius_mm);
  const int reach = static_cast<int>(radius / grid.pitch_mm) + 1;
  const int inner = width - 2 * reach;
  if (inner <= 0) return out;
  const GridPlanes planes(grid);
  BendRow row(static_cast<std::size_t>(inner));
  const float full = kMinSeen * std::numbers::pi_v<float> * (radius * radius);
  for (int v = reach; v + reach < height; ++v) {
    row.clear();
    for (int k = v - reach; k <= v + reach; ++k) {
      for (int i = 0; i <= 2 * reach; ++i)
        add_bends(planes, grid.points.index(reach, v), grid.points.index(i, k), radius * radius, row);
    }
    for (int u = 0; u < inner; ++u) {
      const auto at = static_cast<std::size_t>(u);
      if (!(grid.area_mm2(u + reach, v) > 0)) continue;
      if (row.seen[at] > full) out(u + reach, v) = row.sum[at] / row.sum2[at];
    }
  }
  return out;
}

}  // namespace enamel::pipeline
