#include "pipeline/register/feature/surface_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

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

namespace {

/// One array a coordinate: rows of sums over windows that the compiler takes four at a time.
struct Planes {
  explicit Planes(const Map<Vec3f>& in)
      : x(in.width(), in.height()), y(in.width(), in.height()), z(in.width(), in.height()) {
    for (std::size_t i = 0; i < in.size(); ++i) {
      x[i] = in[i].x();
      y[i] = in[i].y();
      z[i] = in[i].z();
    }
  }
  Map<float> x, y, z;
};

struct BendSums {
  explicit BendSums(std::size_t width) : bend(width), length2(width), seen(width) {}
  void clear() {
    for (auto* sums : {&bend, &length2, &seen}) std::ranges::fill(*sums, 0.0F);
  }
  std::vector<float> bend, length2, seen;
};

struct BendInput {
  BendInput(const SurfaceGrid& grid, float radius)
      : points(grid.points), normals(grid.normals), areas(grid.area_mm2), radius2(radius * radius) {}
  Planes points, normals;
  const Map<float>& areas;
  float radius2;
};

/// Adds what the elements from `other` on are to those from `own` on, one each of the sums.
void add_shifted(const BendInput& in, std::size_t own, std::size_t other, BendSums& out) {
  const Planes &p = in.points, &n = in.normals;
  const float *px = &p.x[own], *py = &p.y[own], *pz = &p.z[own], *qx = &p.x[other], *qy = &p.y[other],
              *qz = &p.z[other];
  const float *nx = &n.x[own], *ny = &n.y[own], *nz = &n.z[own], *mx = &n.x[other], *my = &n.y[other],
              *mz = &n.z[other];
  const float* a = &in.areas[other];
  const float radius2 = in.radius2;
  float* __restrict bend = out.bend.data(), * __restrict length2 = out.length2.data(), * __restrict seen = out.seen.data();
  const std::size_t count = out.seen.size();
  for (std::size_t u = 0; u < count; ++u) {
    const float dx = qx[u] - px[u], dy = qy[u] - py[u], dz = qz[u] - pz[u];
    const float d2 = dx * dx + (dy * dy + dz * dz);
    const float area = a[u] * static_cast<float>(d2 < radius2);  // no branch: the loop is taken four at a time
    bend[u] += area * (dx * (mx[u] - nx[u]) + (dy * (my[u] - ny[u]) + dz * (mz[u] - nz[u])));
    length2[u] += area * d2;
    seen[u] += area;
  }
}

}  // namespace

Map<float> bending(const SurfaceGrid& grid, double radius_mm) {
  const int width = grid.points.width();
  const int height = grid.points.height();
  Map<float> out(width, height, std::numeric_limits<float>::quiet_NaN());
  const auto radius = static_cast<float>(radius_mm);
  const int reach = static_cast<int>(radius / grid.pitch_mm) + 1;
  if (width <= 2 * reach) return out;
  const BendInput input(grid, radius);
  const float full = kMinSeen * std::numbers::pi_v<float> * input.radius2;
  const auto count = static_cast<std::size_t>(width - 2 * reach);
  BendSums sums(count);
  for (int v = reach; v + reach < height; ++v) {
    sums.clear();
    const std::size_t own = grid.points.index(reach, v);
    for (int k = v - reach; k <= v + reach; ++k) {
      for (int i = 0; i <= 2 * reach; ++i) add_shifted(input, own, grid.points.index(i, k), sums);
    }
    for (std::size_t u = 0; u < count; ++u) {
      if (grid.area_mm2[own + u] > 0 && sums.seen[u] > full) out[own + u] = sums.bend[u] / sums.length2[u];
    }
  }
  return out;
}

}  // namespace enamel::pipeline
