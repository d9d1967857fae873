#include "pipeline/decode/triangulate/normal_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/triangulate/normal_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// derived: half of what the weakest usable pairs (1,0),(0,1) give, 4 * 4; pairs along one line give 0.
constexpr float kMinDet = 8;

/// 2x2 normal equations of the plane 1/z = q + qu u + qv v. The squares of the distances are small whole numbers, the
/// same for all pixels: one sum holds all three, in quarters, uu in bits 0-7, vv in bits 8-15 and uv, signed, above.
struct Sums {
  std::int32_t squares = 0;
  float u = 0, v = 0;

  [[nodiscard]] float uu() const { return static_cast<float>(4 * (squares & 0xFF)); }
  [[nodiscard]] float vv() const { return static_cast<float>(4 * ((squares >> 8) & 0xFF)); }
  [[nodiscard]] float uv() const { return static_cast<float>(4 * (squares >> 16)); }
};

/// Adds the pixels at +-(kDu, kDv), unless the step between them is too high for one surface.
template <int kDu, int kDv>
[[gnu::always_inline]] inline void add_pair(const float* below, const float* above, int x, float limit, Sums& s) {
  // layout: sides, square and length of the pair, 2 sqrt(kSquare).
  constexpr float kU = 2 * kDu, kV = 2 * kDv;
  constexpr int kSquare = kDu * kDu + kDv * kDv;
  constexpr float kLength = kSquare == 1 ? 2 : kSquare == 9 ? 6 : kSquare == 8 ? 5.656854249F : 6.324555320F;
  static_assert(kSquare == 1 || kSquare == 8 || kSquare == 9 || kSquare == 10);
  const float d = below[x + kDu] - above[x - kDu];
  const bool same = std::abs(d) < limit * kLength;  // false for NaN
  const float e = select(same, d, 0);
  // layout: of Sums::squares.
  constexpr std::int32_t kSquares = kDu * kDu + kDv * kDv * 256 + kDu * kDv * 65536;
  s.squares += same ? kSquares : 0;
  if constexpr (kDu != 0) s.u += kU * e;
  if constexpr (kDv != 0) s.v += kV * e;
}

/// layout: between the loops over a row, a stretch of it at a time: a processor looks some 200 instructions ahead, so a
/// long loop that ends in division and root would wait for them in every turn. Short enough for many to have no depth.
constexpr int kStretch = 64;
struct Stretch {
  std::array<float, kStretch> uu, uv, vv, u, v;
};

void sum_loop(const NormalWindow& w, const float* sigma_mm, float step, int from, int count, Stretch& sums) {
  const float* __restrict q = w[3] + from, * __restrict sigma = sigma_mm + from;
  const float* __restrict above1 = w[2] + from, * __restrict above2 = w[1] + from, * __restrict above3 = w[0] + from;
  const float* __restrict below1 = w[4] + from, * __restrict below2 = w[5] + from, * __restrict below3 = w[6] + from;
  float* __restrict uu = sums.uu.data(), * __restrict uv = sums.uv.data(), * __restrict vv = sums.vv.data();
  float* __restrict u = sums.u.data(), * __restrict v = sums.v.data();
  ENAMEL_INDEPENDENT
  for (int x = 0; x < count; ++x) {
    // A pixel's step on a surface of that slope, and 4 sigma of a difference, both as change of 1/z.
    const float limit = q[x] * (step + 5.7F * sigma[x] * q[x]);
    // A ring of radius 3 (lever arm against noise) and the four-neighbours (something to go by beside an edge).
    Sums s;
    add_pair<1, 0>(q, q, x, limit, s);
    add_pair<0, 1>(below1, above1, x, limit, s);
    add_pair<3, 0>(q, q, x, limit, s);
    add_pair<0, 3>(below3, above3, x, limit, s);
    add_pair<2, 2>(below2, above2, x, limit, s);
    add_pair<-2, 2>(below2, above2, x, limit, s);
    add_pair<3, 1>(below1, above1, x, limit, s);
    add_pair<1, 3>(below3, above3, x, limit, s);
    add_pair<-3, 1>(below1, above1, x, limit, s);
    add_pair<-1, 3>(below3, above3, x, limit, s);
    uu[x] = s.uu(), uv[x] = s.uv(), vv[x] = s.vv();
    u[x] = s.u, v[x] = s.v;
  }
}

/// u and v become 1/z per unit of the normalised coordinates.
void slope_loop(const RowGeometry& g, int count, Stretch& sums) {
  const float per_x = 1 / g.per_px_x, per_y = 1 / g.per_px_y;
  const float* __restrict uu = sums.uu.data(), * __restrict uv = sums.uv.data(), * __restrict vv = sums.vv.data();
  float* __restrict u = sums.u.data(), * __restrict v = sums.v.data();
  ENAMEL_INDEPENDENT
  for (int x = 0; x < count; ++x) {
    const float inverse = 1.0F / larger(uu[x] * vv[x] - uv[x] * uv[x], kMinDet);
    const float qx = (vv[x] * u[x] - uv[x] * v[x]) * inverse * per_x;
    const float qy = (uu[x] * v[x] - uv[x] * u[x]) * inverse * per_y;
    u[x] = qx;
    v[x] = qy;
  }
}

void normal_loop(const float* inverse_depth, const RowGeometry& g, int from, int count, const Stretch& sums,
                 const NormalRow& out) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const float* __restrict q = inverse_depth + from, * __restrict ray_x = g.x + from, * __restrict ray_y = g.y + from;
  const float* __restrict uu = sums.uu.data(), * __restrict uv = sums.uv.data(), * __restrict vv = sums.vv.data();
  const float* __restrict u = sums.u.data(), * __restrict v = sums.v.data();
  float* __restrict nx = out.x + from, * __restrict ny = out.y + from, * __restrict nz = out.z + from;
  ENAMEL_INDEPENDENT
  for (int x = 0; x < count; ++x) {
    const float det = uu[x] * vv[x] - uv[x] * uv[x];
    const float qx = u[x], qy = v[x], qz = q[x] - ray_x[x] * qx - ray_y[x] * qy;
    const float length = root(qx * qx + qy * qy + qz * qz);
    const float scale = select((det > kMinDet) & (q[x] > 0), -1.0F / length, kNan);
    nx[x] = qx * scale;
    ny[x] = qy * scale;
    nz[x] = qz * scale;
  }
}

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

bool has_depth(const float* inverse_depth, int count) {
  const float* __restrict q = inverse_depth;
  int some = 0;
  for (int x = 0; x < count; ++x) some |= static_cast<int>(q[x] > 0);
  return some != 0;
}

void row_loop(const NormalWindow& w, const float* sigma_mm, const RowGeometry& g, int width, const NormalRow& out) {
  Stretch sums;
  for (int from = 0; from < width; from += kStretch) {
    const int count = std::min(kStretch, width - from);
    if (!has_depth(w[3] + from, count)) {
      for (float* normal : {out.x, out.y, out.z}) std::fill_n(normal + from, count, kNone);
      continue;
    }
    sum_loop(w, sigma_mm, g.max_slope * g.per_px_x, from, count, sums);
    slope_loop(g, count, sums);
    normal_loop(w[3], g, from, count, sums, out);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(row_loop);

void normals_of_row(const NormalWindow& window, const float* sigma_mm, const RowGeometry& geometry, int width,
                    const NormalRow& out) {
  HWY_DYNAMIC_DISPATCH(row_loop)(window, sigma_mm, geometry, width, out);
}

}  // namespace enamel::pipeline
#endif
