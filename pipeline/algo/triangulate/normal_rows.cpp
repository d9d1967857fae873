#include "pipeline/algo/triangulate/normal_rows.hpp"

#include <cmath>
#include <limits>

#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/triangulate/normal_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

/// 2x2 normal equations of the plane 1/z = q + qu u + qv v.
struct Sums {
  float uu = 0, uv = 0, vv = 0, u = 0, v = 0;
};

/// Adds the pixels at +-(kDu, kDv), unless the step between them is too high for one surface.
template <int kDu, int kDv>
[[gnu::always_inline]] inline void add_pair(const float* below, const float* above, int x, float limit, Sums& s) {
  constexpr float kU = 2 * kDu, kV = 2 * kDv;
  constexpr int kSquare = kDu * kDu + kDv * kDv;
  constexpr float kLength = kSquare == 1 ? 2 : kSquare == 9 ? 6 : kSquare == 8 ? 5.656854249F : 6.324555320F;
  static_assert(kSquare == 1 || kSquare == 8 || kSquare == 9 || kSquare == 10);
  const float d = below[x + kDu] - above[x - kDu];
  const bool same = std::abs(d) < limit * kLength;  // false for NaN
  const float e = select(same, d, 0);
  if constexpr (kDu != 0) {
    s.uu += select(same, kU * kU, 0);
    s.u += kU * e;
  }
  if constexpr (kDv != 0) {
    s.vv += select(same, kV * kV, 0);
    s.v += kV * e;
  }
  if constexpr (kDu * kDv != 0) s.uv += select(same, kU * kV, 0);
}

void row_loop(const NormalWindow& w, const float* sigma_mm, const RowGeometry& g, int width, const NormalRow& out) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const float* __restrict q = w[3], * __restrict above1 = w[2], * __restrict above2 = w[1], * __restrict above3 = w[0];
  const float* __restrict below1 = w[4], * __restrict below2 = w[5], * __restrict below3 = w[6];
  const float* __restrict sigma = sigma_mm, * __restrict ray_x = g.x, * __restrict ray_y = g.y;
  const float step = g.max_slope * g.per_px_x, per_x = 1 / g.per_px_x, per_y = 1 / g.per_px_y;
  float* __restrict nx = out.x, * __restrict ny = out.y, * __restrict nz = out.z;
  ENAMEL_INDEPENDENT
  for (int x = 0; x < width; ++x) {
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
    const float det = s.uu * s.vv - s.uv * s.uv;
    const float inverse = 1.0F / larger(det, 8.0F);  // the weakest usable pairs (1,0),(0,1) give 16
    const float qx = (s.vv * s.u - s.uv * s.v) * inverse * per_x;
    const float qy = (s.uu * s.v - s.uv * s.u) * inverse * per_y;
    const float qz = q[x] - ray_x[x] * qx - ray_y[x] * qy;
    const float length = root(qx * qx + qy * qy + qz * qz);
    const float scale = select((det > 8.0F) & (q[x] > 0), -1.0F / length, kNan);
    nx[x] = qx * scale;
    ny[x] = qy * scale;
    nz[x] = qz * scale;
  }
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(row_loop);

void normals_of_row(const NormalWindow& window, const float* sigma_mm, const RowGeometry& geometry, int width,
                    const NormalRow& out) {
  HWY_DYNAMIC_DISPATCH(row_loop)(window, sigma_mm, geometry, width, out);
}

}  // namespace enamel::algo
#endif
