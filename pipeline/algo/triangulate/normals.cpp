#include "pipeline/algo/triangulate/normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

struct Offset {
  int du, dv;
};
/// A ring of radius 3 (lever arm against noise) and the four-neighbours (something to go by beside an edge).
constexpr std::array<Offset, 10> kPairs = {
    {{1, 0}, {0, 1}, {3, 0}, {0, 3}, {2, 2}, {2, -2}, {3, 1}, {1, 3}, {3, -1}, {1, -3}}};

/// Sums of the 2x2 normal equations of one row, five arrays of the row's length.
struct RowSums {
  float *uu, *uv, *vv, *u, *v;
};

void add_pair(const float* plus, const float* minus, const float* limit, Offset o, int begin, int end,
              const RowSums& s) {
  const auto du = static_cast<float>(2 * o.du), dv = static_cast<float>(2 * o.dv);
  const float reach = root(du * du + dv * dv), duu = du * du, duv = du * dv, dvv = dv * dv;
  const float* __restrict p = plus, * __restrict m = minus, * __restrict most = limit;
  float* __restrict uu = s.uu, * __restrict uv = s.uv, * __restrict vv = s.vv, * __restrict su = s.u, * __restrict sv = s.v;
  ENAMEL_INDEPENDENT
  for (int x = begin; x < end; ++x) {
    const float d = p[x] - m[x];
    const bool same = std::abs(d) < most[x] * reach;  // false for NaN
    const float e = select(same, d, 0);
    uu[x] += select(same, duu, 0);
    uv[x] += select(same, duv, 0);
    vv[x] += select(same, dvv, 0);
    su[x] += du * e;
    sv[x] += dv * e;
  }
}

struct RowGeometry {
  const float *x, *y;
  float per_px_x, per_px_y;  ///< change of the normalised coordinate per pixel
};

void solve_row(const RowSums& s, const float* q, const RowGeometry& g, int width, Vec3f* out) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  ENAMEL_INDEPENDENT
  for (int u = 0; u < width; ++u) {
    const float det = s.uu[u] * s.vv[u] - s.uv[u] * s.uv[u];
    const float inverse = 1.0F / larger(det, 8.0F);  // the weakest usable pairs (1,0),(0,1) give 16
    const float qx = (s.vv[u] * s.u[u] - s.uv[u] * s.v[u]) * inverse / g.per_px_x;
    const float qy = (s.uu[u] * s.v[u] - s.uv[u] * s.u[u]) * inverse / g.per_px_y;
    const float nz = q[u] - g.x[u] * qx - g.y[u] * qy;
    const float length = root(qx * qx + qy * qy + nz * nz);
    const float scale = select((det > 8.0F) & (q[u] > 0), -1.0F / length, kNan);
    out[u] = Vec3f(qx * scale, qy * scale, nz * scale);
  }
}

}  // namespace

void compute_normals(const RayDepth& rays, const Map<float>& inverse_depth, const Map<float>& sigma_mm,
                     const NormalConfig& config, std::vector<float>& scratch, Map<Vec3f>& normals) {
  const int w = inverse_depth.width(), h = inverse_depth.height();
  const auto row = static_cast<std::size_t>(w);
  if (normals.width() != w || normals.height() != h) normals = Map<Vec3f>(w, h, Vec3f::Zero());
  scratch.resize(6 * row);
  const RowSums sums{scratch.data(), &scratch[row], &scratch[2 * row], &scratch[3 * row], &scratch[4 * row]};
  float* limit = &scratch[5 * row];
  const std::size_t centre = inverse_depth.index(w / 2, h / 2);
  const float px_x = rays.rays.x[centre + 1] - rays.rays.x[centre];
  const float px_y = rays.rays.y[centre + row] - rays.rays.y[centre];
  const auto slope = static_cast<float>(std::tan(static_cast<double>(config.max_slope_deg) * std::numbers::pi / 180));
  for (int v = 0; v < h; ++v) {
    const std::size_t at = static_cast<std::size_t>(v) * row;
    std::fill_n(scratch.begin(), 5 * row, 0.0F);
    const float* q = &inverse_depth[at];
    const float* sigma = &sigma_mm[at];
    // A pixel's step on a surface of that slope, and 4 sigma of a difference, both as change of 1/z.
    for (std::size_t u = 0; u < row; ++u) limit[u] = q[u] * (slope * px_x + 5.7F * sigma[u] * q[u]);
    for (const Offset o : kPairs) {
      if (v - std::abs(o.dv) < 0 || v + std::abs(o.dv) >= h) continue;
      const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(o.dv) * w + o.du;
      add_pair(q + step, q - step, limit, o, std::abs(o.du), w - std::abs(o.du), sums);
    }
    solve_row(sums, q, {&rays.rays.x[at], &rays.rays.y[at], px_x, px_y}, w, &normals[at]);
  }
}

}  // namespace enamel::algo
