#include "pipeline/model/fuse/surfel_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pipeline/types/loops.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/model/fuse/surfel_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// derived: a second difference of three equal sigmas has std sqrt(6) sigma; 3.5 of those is noise, more is an edge.
constexpr float kBendLimit = 8.5F;

/// Mean of three collinear depths, or the middle one where they bend or one is missing (comparisons with NaN are
/// false).
[[gnu::always_inline]] inline void average_of(float before, float here, float after, float sigma, float& mean,
                                              float& support) {
  const bool flat = std::fabs((before + after) - 2.0F * here) < kBendLimit * sigma;
  mean = select(flat, ((before + after) + here) * (1.0F / 3.0F), here);
  support = select(flat, 3.0F, 1.0F);
}

template <std::ptrdiff_t kStride>
void row_loop(const RowMeans& row) {
  const float* __restrict z = row.depth + kStride * row.first, * __restrict sigma = row.sigma + kStride * row.first;
  float* __restrict mean = row.mean + row.first, * __restrict support = row.support + row.first;
  const std::ptrdiff_t count = row.count;
  ENAMEL_INDEPENDENT
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::ptrdiff_t u = kStride * i;
    average_of(z[u - 1], z[u], z[u + 1], sigma[u], mean[i], support[i]);
  }
}

template <std::ptrdiff_t kStride>
void column_loop(const ColumnMeans& rows) {
  const float* __restrict above = rows.above, * __restrict here = rows.here, * __restrict below = rows.below;
  const float* __restrict from = rows.support_here, * __restrict sigma = rows.sigma;
  float* __restrict mean = rows.mean, * __restrict support = rows.support;
  const std::ptrdiff_t count = rows.count;
  ENAMEL_INDEPENDENT
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    float own = 1;
    average_of(above[i], here[i], below[i], sigma[kStride * i], mean[i], own);
    support[i] = from[i] * own;
  }
}

void rows_of(const RowMeans& row) { row.stride == 2 ? row_loop<2>(row) : row_loop<1>(row); }
void columns_of(const ColumnMeans& rows) { rows.stride == 2 ? column_loop<2>(rows) : column_loop<1>(rows); }

SurfelCounts weigh_loop(const float* dots, const float* depths, const float* sigmas, const float* cosines,
                        const SurfelLimits& limits, int count, float* per_depths, float* weights) {
  const float* __restrict dot = dots, * __restrict z = depths, * __restrict sigma = sigmas;
  const float* __restrict to_axis = cosines;
  float* __restrict per_depth = per_depths, * __restrict weight = weights;
  const auto [cos_min, sigma_ref2, weight_max] = limits;
  int used = 0, steep = 0;
  ENAMEL_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    per_depth[i] = dot[i] / z[i];
    const float cosine = -per_depth[i] * to_axis[i];
    const float full = std::min(weight_max, cosine * (sigma_ref2 / (sigma[i] * sigma[i])));
    const bool usable = (sigma[i] > 0.0F) & (z[i] > 0.0F) & (cosine > 0.0F) & (cosine < 1.01F);  // false for NaN
    const bool facing = usable & (cosine >= cos_min);
    weight[i] = select(facing, full, 0.0F);
    used += facing ? 1 : 0;
    steep += (usable & !facing) ? 1 : 0;
  }
  return {used, steep};
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(rows_of);
HWY_EXPORT(columns_of);
HWY_EXPORT(weigh_loop);

void average_along_row(const RowMeans& row) { HWY_DYNAMIC_DISPATCH(rows_of)(row); }
void average_across_rows(const ColumnMeans& rows) { HWY_DYNAMIC_DISPATCH(columns_of)(rows); }

SurfelCounts weigh_surfels(const float* dot, const float* z, const float* sigma, const float* cos_to_axis,
                           const SurfelLimits& limits, int count, float* per_depth, float* weight) {
  return HWY_DYNAMIC_DISPATCH(weigh_loop)(dot, z, sigma, cos_to_axis, limits, count, per_depth, weight);
}

}  // namespace enamel::pipeline
#endif
