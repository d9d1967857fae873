#include "pipeline/decode/unwrap/segment_rows.hpp"

#include <cmath>
#include <limits>

#include "pipeline/decode/phase/poly_trig.hpp"
#define ENAMEL_NO_AVX512
#include "pipeline/decode/unwrap/chosen.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/unwrap/segment_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

constexpr std::size_t kKinkContext_px = 6;  ///< layout: that the loops reach to either side

/// Height of a step as excess over the slopes beside it; blur spreads a step over three pixels. One-sided at the end of
/// a surface; NaN where there is nothing to compare.
[[gnu::always_inline]] inline float excess(float middle, float before, float after) {
  const bool left = before == before, right = after == after;
  return middle - select(left, select(right, 0.5F * (before + after), before), after);
}

void unwrap_loop(const FloodRow& row, std::size_t width, float* phi) {
  const float* __restrict phase = row.phase;
  const std::int16_t* __restrict wraps = row.wraps;
  const std::int32_t* __restrict component = row.component;
  float* __restrict out = phi;
  for (std::size_t u = 0; u < width; ++u) {
    const float p = phase[u] + kTwoPiF * static_cast<float>(wraps[u]);
    out[u] = select(component[u] >= 0, p, std::numeric_limits<float>::quiet_NaN());
  }
}

void kink_loop(const float* phi, const float* noise, std::size_t width, float* heights, std::uint8_t* kinks) {
  const float* __restrict p = phi, * __restrict sigma = noise;
  float* __restrict height = heights;
  std::uint8_t* __restrict out = kinks;
  for (std::size_t u = 0; u < width; ++u) height[u] = 0;
  for (std::size_t u = 0; u < width; ++u) out[u] = 0;
  if (width <= 2 * kKinkContext_px) return;
  const std::size_t end = width - kKinkContext_px;
  for (std::size_t u = kKinkContext_px - 1; u < end + 1; ++u)
    height[u] = std::abs(excess(p[u + 1] - p[u - 2], p[u - 2] - p[u - 5], p[u + 4] - p[u + 1]));
  for (std::size_t u = kKinkContext_px; u < end; ++u) {
    const bool step = height[u] > step_threshold(sigma[u], 1);
    const bool before = height[u - 1] > height[u], after = height[u + 1] >= height[u];
    out[u] = static_cast<std::uint8_t>(step & !before & !after);
  }
}

/// Mean of the modulation over the rows and the pixels that are in a component; NaN where the row's own is in none.
[[gnu::always_inline]] inline void mean_over_rows(const ShadeRows& rows, std::ptrdiff_t above, std::ptrdiff_t below,
                                                  std::size_t width, float* means) {
  const auto pitch = static_cast<std::ptrdiff_t>(width);
  const float* __restrict modulation = rows.modulation;
  const std::int32_t* __restrict component = rows.component;
  float* __restrict mean = means;
  for (std::ptrdiff_t u = 0; u < pitch; ++u) {
    float sum = 0, count = 0;
    for (std::ptrdiff_t r = -above; r <= below; ++r) {
      const bool seen = component[u + r * pitch] >= 0;
      sum += select(seen, modulation[u + r * pitch], 0);
      count += select(seen, 1, 0);
    }
    mean[u] = select(component[u] >= 0, sum / larger(count, 1), std::numeric_limits<float>::quiet_NaN());
  }
}

void shade_loop(const ShadeRows& rows, std::size_t width, float* means, float* steps, std::uint8_t* marks) {
  float* __restrict height = steps;
  std::uint8_t* __restrict borders = marks;
  for (std::size_t u = 0; u < width; ++u) height[u] = 0;
  if (width <= 2 * kKinkContext_px) return;
  if (rows.above == kShadeReach_px && rows.below == kShadeReach_px) {
    mean_over_rows(rows, kShadeReach_px, kShadeReach_px, width, means);  // constants: the compiler unrolls them
  } else {
    mean_over_rows(rows, rows.above, rows.below, width, means);
  }
  const float* __restrict mean = means;
  const std::size_t end = width - kKinkContext_px;
  for (std::size_t u = kKinkContext_px - 1; u < end + 1; ++u) {
    const float slopes = 0.5F * (mean[u - 2] - mean[u - 5] + (mean[u + 4] - mean[u + 1]));
    const float step = mean[u + 1] - mean[u - 2] - slopes;
    height[u] = select(step == step, std::abs(step) / mean[u], 0);
  }
  const float* __restrict sigma = rows.sigma;
  const float noise = kShadeSigmas / root(static_cast<float>(rows.above + rows.below + 1));
  for (std::size_t u = kKinkContext_px; u < end; ++u) {
    const bool step = height[u] > larger(noise * sigma[u], kLeastShade);
    const bool before = height[u - 1] > height[u], after = height[u + 1] >= height[u];
    const int highest = step & !before & !after;
    borders[u] = static_cast<std::uint8_t>(borders[u] | (highest * kShade));
  }
}

void mark_loop(const FloodRow& row, const float* unwrapped, const std::uint8_t* kinked, std::size_t width,
               std::uint8_t* marks) {
  const float* __restrict phase = row.phase, * __restrict phi = unwrapped;
  const std::int16_t* __restrict wraps = row.wraps;
  const std::int32_t* __restrict component = row.component;
  const std::uint8_t* __restrict east = row.east, * __restrict kinks = kinked;
  std::uint8_t* __restrict out = marks;
  out[0] = component[0] < 0 ? kHole : kFirst;
  for (std::size_t u = 1; u < width; ++u) {
    const int cell = 2 * wraps[u] - static_cast<int>(phase[u] < 0);
    const int before = 2 * wraps[u - 1] - static_cast<int>(phase[u - 1] < 0);
    // A difference beyond pi: two paths of the flood disagree here.
    const bool joined =
        (east[u - 1] != 0) & (component[u - 1] == component[u]) & (std::abs(phi[u] - phi[u - 1]) < kPiF);
    const int unshaded = cell != before ? kNextCell : kInside;
    const int smooth = (kinks[u] & kShade) != 0 ? kAfterShade : unshaded;
    const int within = (kinks[u] & kKink) != 0 ? kAfterKink : smooth;
    const int mark = component[u] < 0 ? kHole : (joined ? within : kFirst);
    out[u] = static_cast<std::uint8_t>(mark);
  }
}

void border_loop(const float* phi, const float* noise, const std::uint8_t* links, bool room, std::size_t width,
                 BorderColumn* out) {
  const float* __restrict sigma = noise;
  const std::uint8_t* __restrict south = links;
  BorderColumn* __restrict column = out;
  if (!room) {
    for (std::size_t u = 0; u < width; ++u) column[u] = {0, 0, 0, static_cast<float>(south[u])};
    return;
  }
  const auto row = static_cast<std::ptrdiff_t>(width);
  const float* __restrict p1 = phi + row, * __restrict p4 = phi + 4 * row;
  const float* __restrict m2 = phi - 2 * row, * __restrict m5 = phi - 5 * row;
  for (std::size_t u = 0; u < width; ++u) {
    const float height = excess(p1[u] - m2[u], m2[u] - m5[u], p4[u] - p1[u]);
    const bool seen = height == height;
    column[u].height = select(seen, height, 0);
    column[u].sigma = select(seen, sigma[u], 0);
    column[u].seen = select(seen, 1, 0);
    column[u].linked = static_cast<float>(south[u]);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(unwrap_loop);
HWY_EXPORT(kink_loop);
HWY_EXPORT(shade_loop);
HWY_EXPORT(mark_loop);
HWY_EXPORT(border_loop);

void unwrap_row(const FloodRow& row, std::size_t width, float* phi) {
  HWY_DYNAMIC_DISPATCH(unwrap_loop)(row, width, phi);
}

void kink_row(const float* phi, const float* sigma, std::size_t width, float* heights, std::uint8_t* kinks) {
  HWY_DYNAMIC_DISPATCH(kink_loop)(phi, sigma, width, heights, kinks);
}

void shade_row(const ShadeRows& rows, std::size_t width, float* mean, float* heights, std::uint8_t* borders) {
  HWY_DYNAMIC_DISPATCH(shade_loop)(rows, width, mean, heights, borders);
}

void mark_row(const FloodRow& row, const float* phi, const std::uint8_t* kinks, std::size_t width,
              std::uint8_t* marks) {
  HWY_DYNAMIC_DISPATCH(mark_loop)(row, phi, kinks, width, marks);
}

void border_row(const float* phi, const float* sigma, const std::uint8_t* south, bool room, std::size_t width,
                BorderColumn* out) {
  HWY_DYNAMIC_DISPATCH(border_loop)(phi, sigma, south, room, width, out);
}

}  // namespace enamel::pipeline
#endif
