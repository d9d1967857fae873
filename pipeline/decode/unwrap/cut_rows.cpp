#include "pipeline/decode/unwrap/cut_rows.hpp"

#include <bit>
#include <cmath>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/unwrap/cut_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// ln x for normal x > 0 within 0.06: exponent and mantissa as one straight line an octave. Costs need no more.
[[gnu::always_inline]] inline float rough_log(float x) {
  // layout: coefficients of that line.
  constexpr float kLog2 = 0.69314718F, kPerStep = kLog2 / 8388608.0F, kBias = 127 * kLog2 - 0.03F;
  return static_cast<float>(static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(x))) * kPerStep - kBias;
}

void cost_loop(const PixelRow& r, std::ptrdiff_t step, std::size_t count, const LineOfDifferences& line, float slope,
               const CutConfig& c, float odds, std::uint8_t* cost) {
  const float* __restrict s = r.sigma, * __restrict t = r.sigma + step;
  const float* __restrict before = line.before, * __restrict here = line.here, * __restrict after = line.after;
  std::uint8_t* __restrict out = cost;
  const float steepest = c.max_slope_rad, bend = c.curvature_rad * c.curvature_rad, any_slope = slope * slope / 3;
  for (std::size_t u = 0; u < count; ++u) {
    const bool left = std::abs(before[u]) < steepest, right = std::abs(after[u]) < steepest;
    const float share = select(left & right, 0.5F, 1);
    const float expected = share * (select(left, before[u], 0) + select(right, after[u], 0));
    const float noise = 0.5F * (s[u] * s[u] + t[u] * t[u]);
    const float variance =
        select(left | right, select(left & right, 5, 6) * noise + bend, 2 * noise + any_slope + bend);
    const float x = here[u] - expected;
    const float nats = odds - 0.5F * rough_log(variance) - 0.5F * x * x / variance;
    const float scaled = smaller(larger(static_cast<float>(kCostPerNat) * nats, kLeastCost), 255);
    out[u] = static_cast<std::uint8_t>(static_cast<std::int32_t>(select(here[u] < 5, scaled, 0)));
  }
}

void wrap_loop(const PixelRow& r, std::ptrdiff_t step, std::size_t count, const float* difference, std::int8_t* wraps) {
  const float* __restrict p = r.phase, * __restrict q = r.phase + step, * __restrict e = difference;
  const float* __restrict c = r.carrier, * __restrict d = r.carrier + step;
  std::int8_t* __restrict out = wraps;
  for (std::size_t u = 0; u < count; ++u) {
    const float gained = select(e[u] < 5, e[u] + (d[u] - c[u]) - (q[u] - p[u]), 0);
    out[u] = static_cast<std::int8_t>(static_cast<int>(gained > kPiF) - static_cast<int>(gained < -kPiF));
  }
}

void residue_loop(const std::int8_t* east, const std::int8_t* east_below, const std::int8_t* south, std::size_t count,
                  std::uint8_t* residues) {
  const std::int8_t* __restrict top = east, * __restrict bottom = east_below, * __restrict side = south;
  std::uint8_t* __restrict out = residues;
  for (std::size_t u = 0; u < count; ++u)
    out[u] = static_cast<std::uint8_t>(top[u] + side[u + 1] - bottom[u] - side[u]);
}

void torn_loop(const std::uint8_t* valid, const std::uint8_t* valid_below, std::size_t count, std::uint8_t* torn) {
  const std::uint8_t* __restrict top = valid, * __restrict bottom = valid_below;
  std::uint8_t* __restrict out = torn;
  for (std::size_t u = 0; u < count; ++u)
    out[u] = static_cast<std::uint8_t>((top[u] & top[u + 1] & bottom[u] & bottom[u + 1]) ^ 1U);
}

void segment_loop(const CutRow& row, std::size_t width, std::uint8_t* marks) {
  const std::uint8_t* __restrict valid = row.valid, * __restrict cost = row.cost - 1;
  const std::int8_t* __restrict wraps = row.wraps - 1;
  const std::int16_t* __restrict cut = row.cut - 1;
  std::uint8_t* __restrict out = marks;
  for (std::size_t u = 0; u < width; ++u) {
    const bool same = (cost[u] > kLeastCost) & (wraps[u] == 0) & (cut[u] == 0);
    out[u] = static_cast<std::uint8_t>(valid[u] == 0 ? kNoPixel : (same ? kSameRun : kRunEvent));
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(cost_loop);
HWY_EXPORT(wrap_loop);
HWY_EXPORT(residue_loop);
HWY_EXPORT(torn_loop);
HWY_EXPORT(segment_loop);

void cut_cost_row(const PixelRow& r, std::ptrdiff_t step, std::size_t count, const LineOfDifferences& line, float slope,
                  const CutConfig& config, std::uint8_t* cost) {
  constexpr float kHalfLogTwoPi = 0.91893853F;  // derived: ln(2 pi/sqrt(2 pi)), of cut_costs.hpp
  const float odds = kHalfLogTwoPi + std::log(config.links_per_jump);
  HWY_DYNAMIC_DISPATCH(cost_loop)(r, step, count, line, slope, config, odds, cost);
}

void wrap_row(const PixelRow& r, std::ptrdiff_t step, std::size_t count, const float* difference, std::int8_t* wraps) {
  HWY_DYNAMIC_DISPATCH(wrap_loop)(r, step, count, difference, wraps);
}

void residue_row(const std::int8_t* east, const std::int8_t* east_below, const std::int8_t* south, std::size_t count,
                 std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(residue_loop)(east, east_below, south, count, out);
}

void torn_row(const std::uint8_t* valid, const std::uint8_t* below, std::size_t count, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(torn_loop)(valid, below, count, out);
}

void mark_segments(const CutRow& row, std::size_t width, std::uint8_t* marks) {
  HWY_DYNAMIC_DISPATCH(segment_loop)(row, width, marks);
}

}  // namespace enamel::pipeline
#endif
