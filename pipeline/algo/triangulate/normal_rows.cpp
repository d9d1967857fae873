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

void add_loop(const float* plus, const float* minus, const float* limit, PixelOffset o, int begin, int end,
              const NormalSums& s) {
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

void solve_loop(const NormalSums& s, const float* q, const RowGeometry& g, int width, Vec3f* out) {
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

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(add_loop);
HWY_EXPORT(solve_loop);

void add_normal_pair(const float* plus, const float* minus, const float* limit, PixelOffset o, int begin, int end,
                     const NormalSums& s) {
  HWY_DYNAMIC_DISPATCH(add_loop)(plus, minus, limit, o, begin, end, s);
}

void solve_normal_row(const NormalSums& s, const float* q, const RowGeometry& g, int width, Vec3f* out) {
  HWY_DYNAMIC_DISPATCH(solve_loop)(s, q, g, width, out);
}

}  // namespace enamel::algo
#endif
