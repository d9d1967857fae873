#include "pipeline/register/feature/bend_rows.hpp"

#include "pipeline/types/loops.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/register/feature/bend_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void bends_loop(const GridPlanes& grid, std::size_t first, std::size_t neighbour, float radius2, BendRow& row) {
  const float* __restrict x = &grid.x[first], * __restrict y = &grid.y[first], * __restrict z = &grid.z[first];
  const float* __restrict nx = &grid.nx[first], * __restrict ny = &grid.ny[first], * __restrict nz = &grid.nz[first];
  const float* __restrict qx = &grid.x[neighbour], * __restrict qy = &grid.y[neighbour];
  const float* __restrict qz = &grid.z[neighbour], * __restrict area = &grid.area[neighbour];
  const float* __restrict mx = &grid.nx[neighbour], * __restrict my = &grid.ny[neighbour];
  const float* __restrict mz = &grid.nz[neighbour];
  float* __restrict sum = row.sum.data(), * __restrict sum2 = row.sum2.data(), * __restrict seen = row.seen.data();
  const std::size_t width = row.sum.size();
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float dx = qx[u] - x[u], dy = qy[u] - y[u], dz = qz[u] - z[u];
    const float d2 = dx * dx + (dy * dy + dz * dz);
    const float a = select(d2 < radius2, area[u], 0.0F);
    sum[u] += a * (dx * (mx[u] - nx[u]) + (dy * (my[u] - ny[u]) + dz * (mz[u] - nz[u])));
    sum2[u] += a * d2;
    seen[u] += a;
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(bends_loop);

GridPlanes::GridPlanes(const SurfaceGrid& grid) {
  const std::size_t n = grid.points.size();
  for (auto* values : {&x, &y, &z, &nx, &ny, &nz, &area}) values->resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = grid.points[i].x(), y[i] = grid.points[i].y(), z[i] = grid.points[i].z();
    nx[i] = grid.normals[i].x(), ny[i] = grid.normals[i].y(), nz[i] = grid.normals[i].z();
    area[i] = grid.area_mm2[i];
  }
}

void add_bends(const GridPlanes& grid, std::size_t first, std::size_t neighbour, float radius2, BendRow& row) {
  HWY_DYNAMIC_DISPATCH(bends_loop)(grid, first, neighbour, radius2, row);
}

}  // namespace enamel::pipeline
#endif
