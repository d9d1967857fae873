#include "pipeline/model/fuse/view_planes.hpp"

#include <cmath>
#include <limits>

#include "pipeline/types/loops.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/model/fuse/view_planes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, ViewPlanes::kLanes>;

constexpr float kSameSurfaceMm = 0.3F;

/// One row of pixels, the first of which is element `first`.
void normals_loop(ViewPlanes& planes, std::size_t first) {
  const float* __restrict x = planes.x.data() + first, * __restrict y = planes.y.data() + first;
  const float* __restrict z = planes.z.data() + first, * __restrict gx = planes.gx.data() + first;
  const float* __restrict gy = planes.gy.data() + first, * __restrict gz = planes.gz.data() + first;
  float* __restrict nx = planes.nx.data(), * __restrict ny = planes.ny.data(), * __restrict nz = planes.nz.data();
  const auto width = static_cast<std::ptrdiff_t>(planes.width), stride = static_cast<std::ptrdiff_t>(planes.stride);
  ENAMEL_INDEPENDENT
  for (std::ptrdiff_t u = 0; u < width; ++u) {
    float sx = 0, sy = 0, sz = 0;
    const auto add = [&](std::ptrdiff_t at) __attribute__((always_inline)) {
      const float ex = x[at] - x[u], ey = y[at] - y[u], ez = z[at] - z[u];
      const bool same = (ex * ex + ey * ey) + ez * ez < kSameSurfaceMm * kSameSurfaceMm;  // false for NaN
      sx += select(same, gx[at], 0.0F);
      sy += select(same, gy[at], 0.0F);
      sz += select(same, gz[at], 0.0F);
    };
    // Spelt out: a loop in here would keep a compiler from working many pixels at a time.
    add(u - stride - 1), add(u - stride), add(u - stride + 1);
    add(u - 1), add(u), add(u + 1);
    add(u + stride - 1), add(u + stride), add(u + stride + 1);
    nx[u] = sx, ny[u] = sy, nz[u] = sz;
  }
  // By name: a compiler leaves a loop with std::sqrt, which may set errno, as it is.
  const Floats d;
  for (std::size_t u = 0; u < planes.nx.size(); u += hn::Lanes(d)) {
    const auto sx = hn::LoadU(d, nx + u), sy = hn::LoadU(d, ny + u), sz = hn::LoadU(d, nz + u);
    const auto length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(sx, sx), hn::Mul(sy, sy)), hn::Mul(sz, sz)));
    hn::StoreU(hn::Div(sx, length), d, nx + u);
    hn::StoreU(hn::Div(sy, length), d, ny + u);
    hn::StoreU(hn::Div(sz, length), d, nz + u);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(normals_loop);

void ViewPlanes::clear(int view_width, int view_height) {
  width = view_width, height = view_height;
  stride = static_cast<std::size_t>(width) + 2;
  const std::size_t size = stride * (static_cast<std::size_t>(height) + 2);
  x.assign(size, std::numeric_limits<float>::quiet_NaN());
  for (auto* plane : {&y, &z, &gx, &gy, &gz}) plane->resize(size);
  for (auto* row : {&nx, &ny, &nz}) row->resize((static_cast<std::size_t>(width) + kLanes - 1) / kLanes * kLanes);
}

void smooth_normals(ViewPlanes& planes, Map<Vec3f>& normals) {
  const Vec3f none = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (int j = 0; j < planes.height; ++j) {
    const std::size_t first = planes.index(0, j);
    HWY_DYNAMIC_DISPATCH(normals_loop)(planes, first);
    for (int i = 0; i < planes.width; ++i) {
      const auto u = static_cast<std::size_t>(i);
      const bool known = !std::isnan(planes.x[first + u]);
      normals(i, j) = known ? Vec3f(planes.nx[u], planes.ny[u], planes.nz[u]) : none;
    }
  }
}

}  // namespace enamel::pipeline
#endif
