#include "pipeline/decode/unwrap/link_rows.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/unwrap/link_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// derived: 3 sigma of the Laplacian, which has sqrt(20) sigma: a smooth place keeps its quality.
constexpr float kLaplaceSigmas = 3 * 4.4721360F;

void difference_loop(const PixelRow& r, std::ptrdiff_t step, std::size_t count, float* __restrict out) {
  const float* __restrict p = r.phase, * __restrict q = r.phase + step;
  const float* __restrict c = r.carrier, * __restrict d = r.carrier + step;
  const PixelReject* __restrict a = r.reject, * __restrict b = r.reject + step;
  for (std::size_t u = 0; u < count; ++u) {
    const float e = wrap_once(wrap_once(q[u] - p[u]) - (d[u] - c[u]));
    const bool ok = (static_cast<unsigned>(a[u]) | static_cast<unsigned>(b[u])) == 0;  // both kNone
    out[u] = select(ok, e, kInvalidDifference);
  }
}

void link_loop(const PixelRow& r, std::ptrdiff_t step, std::size_t count, const float* __restrict difference,
               float slope, const LinkConfig& c, std::uint8_t* __restrict link) {
  const float* __restrict s = r.sigma, * __restrict t = r.sigma + step;
  const float sigmas = c.noise_sigmas, most = c.max_deviation_rad;
  for (std::size_t u = 0; u < count; ++u) {
    const float limit = smaller(slope + sigmas * root(s[u] * s[u] + t[u] * t[u]), most);
    link[u] = static_cast<std::uint8_t>(std::abs(difference[u]) < limit);
  }
}

void quality_loop(const PixelRow& r, std::size_t width, const float* __restrict east, const float* __restrict south,
                  const float* __restrict north, std::uint8_t* __restrict out) {
  const float* __restrict sigma = r.sigma, * __restrict west = east - 1;
  const PixelReject* __restrict reject = r.reject;
  for (std::size_t u = 0; u < width; ++u) {
    const float l = (east[u] - west[u]) + (south[u] - north[u]);
    const float most = larger(larger(east[u], west[u]), larger(south[u], north[u]));
    const float x = select(most < 5, l / (kLaplaceSigmas * sigma[u]), 4);  // border pixels wait
    const float q = 1.0F / (sigma[u] * (1.0F + x * x));
    // Two steps an octave straight from the float's exponent and mantissa, from 2^-8 on.
    const int level = static_cast<int>(std::bit_cast<std::uint32_t>(q) >> 22U) - (119 << 1);
    const int clamped = std::min(std::max(level, 1), kCleanQuality - 1) + (x * x <= 1 ? kCleanQuality : 0);
    out[u] = static_cast<std::uint8_t>(reject[u] == PixelReject::kNone ? clamped : 0);
  }
}

void cut_loop(const PixelReject* reject, std::ptrdiff_t step, const std::uint8_t* linked, std::size_t count,
              std::uint8_t* marks) {
  const PixelReject* __restrict a = reject, * __restrict b = reject + step;
  const std::uint8_t* __restrict link = linked;
  std::uint8_t* __restrict out = marks;
  for (std::size_t u = 0; u < count; ++u) {
    const bool here = (a[u] == PixelReject::kNone) | (a[u] == PixelReject::kEdge);
    const bool there = (b[u] == PixelReject::kNone) | (b[u] == PixelReject::kEdge);
    out[u] = static_cast<std::uint8_t>(here & there & (link[u] == 0));
  }
}

void half_lit_loop(const float* modulation, std::ptrdiff_t side, std::ptrdiff_t up, std::ptrdiff_t down,
                   std::size_t count, PixelReject* reject) {
  const float* __restrict here = modulation, * __restrict west = here - side, * __restrict east = here + side;
  const float* __restrict above = here + up, * __restrict below = here + down;
  PixelReject* __restrict out = reject;
  for (std::size_t u = 0; u < count; ++u) {
    const float most = larger(larger(west[u], east[u]), larger(above[u], below[u]));
    const auto half_lit = static_cast<unsigned>(here[u] < 0.5F * most), was = static_cast<unsigned>(out[u]);
    out[u] = static_cast<PixelReject>(was == 0 ? half_lit * static_cast<unsigned>(PixelReject::kEdge) : was);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(difference_loop);
HWY_EXPORT(link_loop);
HWY_EXPORT(quality_loop);
HWY_EXPORT(cut_loop);
HWY_EXPORT(half_lit_loop);

void difference_row(const PixelRow& r, std::ptrdiff_t step, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(difference_loop)(r, step, count, out);
}

void link_row(const PixelRow& r, std::ptrdiff_t step, std::size_t count, const float* difference, float slope,
              const LinkConfig& config, std::uint8_t* link) {
  HWY_DYNAMIC_DISPATCH(link_loop)(r, step, count, difference, slope, config, link);
}

void quality_row(const PixelRow& r, std::size_t width, const float* east, const float* south, const float* north,
                 std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(quality_loop)(r, width, east, south, north, out);
}

void mark_cuts(const PixelReject* reject, std::ptrdiff_t step, const std::uint8_t* link, std::size_t count,
               std::uint8_t* marks) {
  HWY_DYNAMIC_DISPATCH(cut_loop)(reject, step, link, count, marks);
}

void half_lit_row(const float* modulation, std::ptrdiff_t side, std::ptrdiff_t up, std::ptrdiff_t down,
                  std::size_t count, PixelReject* reject) {
  HWY_DYNAMIC_DISPATCH(half_lit_loop)(modulation, side, up, down, count, reject);
}

}  // namespace enamel::pipeline
#endif
