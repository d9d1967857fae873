#include "pipeline/decode/triangulate/inverse_depth_rows.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/triangulate/inverse_depth_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// layout: widened before the loop that computes, which mixed widths would slow down.
constexpr std::size_t kStretch = 256;

void inverse_loop(const SparseRow& row, const InverseDepthRange& limits, std::size_t count, float* inverse_depth) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const InverseDepthRange range = limits;
  std::array<std::int32_t, kStretch> wrap_counts, rejects;
  const std::int32_t* __restrict wraps = wrap_counts.data(), * __restrict reject = rejects.data();
  for (std::size_t from = 0; from < count; from += kStretch) {
    const std::size_t n = std::min(kStretch, count - from);
    for (std::size_t k = 0; k < n; ++k) wrap_counts[k] = row.wraps[2 * (from + k)];
    for (std::size_t k = 0; k < n; ++k) rejects[k] = static_cast<std::int32_t>(row.reject[2 * (from + k)]);
    const float* __restrict phase = row.phase + from, * __restrict mid = row.mid + from;
    const float* __restrict c0 = row.c0 + from, * __restrict c1 = row.c1 + from;
    const float* __restrict c2 = row.c2 + from, * __restrict c3 = row.c3 + from;
    float* __restrict out = inverse_depth + from;
    ENAMEL_INDEPENDENT
    for (std::size_t k = 0; k < n; ++k) {
      const float t = phase[k] + kTwoPiF * static_cast<float>(wraps[k]) - mid[k];
      const float q = c0[k] + t * (c1[k] + t * (c2[k] + t * c3[k]));
      const bool ok = (reject[k] == static_cast<int>(PixelReject::kNone)) & (q <= range.q_near) & (q >= range.q_far);
      out[k] = select(ok, q, kNan);
    }
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(inverse_loop);

void inverse_depth_row(const SparseRow& row, const InverseDepthRange& range, std::size_t count, float* inverse_depth) {
  HWY_DYNAMIC_DISPATCH(inverse_loop)(row, range, count, inverse_depth);
}

}  // namespace enamel::pipeline
#endif
