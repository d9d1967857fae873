#include "pipeline/decode/unwrap/flood_rows.hpp"

#include <algorithm>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/unwrap/links.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/unwrap/flood_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void mark_loop(const float* phase, const std::uint8_t* links, const std::uint8_t* qualities, std::size_t width,
               std::uint8_t* marks) {
  const float* __restrict p = phase;
  const std::uint8_t* __restrict east = links, * __restrict quality = qualities;
  std::uint8_t* __restrict out = marks;
  out[0] = quality[0] == 0 ? kNoPixel : kRunEvent;
  for (std::size_t u = 1; u < width; ++u) {
    const bool clean = (east[u - 1] != 0) & (((quality[u] | quality[u - 1]) & kCleanQuality) != 0);
    const bool same = clean & (std::abs(p[u] - p[u - 1]) <= kPiF);
    out[u] = static_cast<std::uint8_t>(quality[u] == 0 ? kNoPixel : (same ? kSameRun : kRunEvent));
  }
}

void compare_loop(const RunRow& upper, const RunRow& lower, const std::uint8_t* links, std::size_t width,
                  const RunBorder& border) {
  constexpr int kLevel = kCleanQuality - 1;  // layout: bits of the level
  const float* __restrict p = upper.phase, * __restrict q = lower.phase;
  const std::int16_t* __restrict from = upper.wraps, * __restrict to = lower.wraps;
  const std::int32_t* __restrict a = upper.run, * __restrict b = lower.run;
  const std::uint8_t* __restrict south = links, * __restrict here = upper.quality, * __restrict below = lower.quality;
  std::int16_t* __restrict wrap_counts = border.wrap_counts;
  std::uint8_t* __restrict weights = border.weights, * __restrict changes = border.changes;
  for (std::size_t u = 0; u < width; ++u)
    wrap_counts[u] = static_cast<std::int16_t>(from[u] + wraps_between(p[u], q[u]) - to[u]);
  for (std::size_t u = 0; u < width; ++u) {
    const int level = std::min(here[u] & kLevel, below[u] & kLevel);
    weights[u] = static_cast<std::uint8_t>(south[u] != 0 ? level : 0);
  }
  changes[0] = 0;
  for (std::size_t u = 1; u < width; ++u) {
    const bool same = (a[u] == a[u - 1]) & (b[u] == b[u - 1]) & (wrap_counts[u] == wrap_counts[u - 1]);
    changes[u] = static_cast<std::uint8_t>(!same);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(mark_loop);
HWY_EXPORT(compare_loop);

void mark_runs(const float* phase, const std::uint8_t* east, const std::uint8_t* quality, std::size_t width,
               std::uint8_t* marks) {
  HWY_DYNAMIC_DISPATCH(mark_loop)(phase, east, quality, width, marks);
}

void compare_runs(const RunRow& upper, const RunRow& lower, const std::uint8_t* south, std::size_t width,
                  const RunBorder& out) {
  HWY_DYNAMIC_DISPATCH(compare_loop)(upper, lower, south, width, out);
}

}  // namespace enamel::pipeline
#endif
