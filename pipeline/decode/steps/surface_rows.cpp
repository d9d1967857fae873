#include "pipeline/decode/steps/surface_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/steps/surface_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// Sum of the ripple's terms by Clenshaw's recursion over 4 phi, from the vector (c, s) of phi: no trigonometry.
[[gnu::always_inline]] inline float ripple_error(const RippleTerms& r, float c, float s) {
  static_assert(kRippleTerms == 4);
  const float inv2 = 1.0F / (c * c + s * s + 1e-6F);
  const float cos2 = (c - s) * (c + s) * inv2, sin2 = 2 * c * s * inv2;
  const float cos4 = 2 * cos2 * cos2 - 1, sin4 = 2 * sin2 * cos2, twice = 2 * cos4;
  const float c3 = r.cosine[2] + twice * r.cosine[3], s3 = r.sine[2] + twice * r.sine[3];
  const float c2 = r.cosine[1] + twice * c3 - r.cosine[3], s2 = r.sine[1] + twice * s3 - r.sine[3];
  const float c1 = r.cosine[0] + twice * c2 - c3, s1 = r.sine[0] + twice * s2 - s3;
  return cos4 * c1 - c2 + sin4 * s1;
}

/// layout: of a row, kStretch pixels at a time: what is narrower than a float is widened before and narrowed after. A
/// loop that mixes widths is unrolled until its values no longer fit the registers.
constexpr std::size_t kStretch = 256;
struct Stretch {
  std::array<std::int32_t, kStretch> wraps, reject, order;
};

void widen(const std::int16_t* wrap_counts, const PixelReject* rejects, std::size_t count, Stretch& out) {
  std::int32_t* __restrict wraps = out.wraps.data(), * __restrict reject = out.reject.data();
  for (std::size_t i = 0; i < count; ++i) wraps[i] = wrap_counts[i];
  for (std::size_t i = 0; i < count; ++i) reject[i] = static_cast<std::int32_t>(rejects[i]);
}

void narrow(const Stretch& in, std::size_t count, PixelReject* rejects, std::uint8_t* orders) {
  const std::int32_t* __restrict reject = in.reject.data(), * __restrict order = in.order.data();
  for (std::size_t i = 0; i < count; ++i) rejects[i] = static_cast<PixelReject>(reject[i]);
  for (std::size_t i = 0; i < count; ++i) orders[i] = static_cast<std::uint8_t>(order[i]);
}

void surface_stretch(const SurfaceRow& row, const InverseDepthRange& limits, const RippleTerms& terms, std::size_t from,
                     std::size_t count, const SurfaceRowOut& o, Stretch& s) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr auto kDark = static_cast<int>(PixelReject::kDark), kNoisy = static_cast<int>(PixelReject::kNoisy);
  static_assert(static_cast<int>(PixelReject::kSaturated) == kDark + 1 && kNoisy == kDark + 2);
  const RippleTerms ripple = terms;  // copies cannot alias what is written
  const InverseDepthRange range = limits;
  const float* __restrict phase = row.phase + from, * __restrict cosine = row.cosine + from;
  const float* __restrict sine = row.sine + from, * __restrict sigma = row.sigma + from;
  const float* __restrict mid = row.mid + from, * __restrict c0 = row.c0 + from, * __restrict c1 = row.c1 + from;
  const float* __restrict c2 = row.c2 + from, * __restrict c3 = row.c3 + from;
  const float* __restrict ray_x = row.ray_x + from, * __restrict ray_y = row.ray_y + from;
  float* __restrict inverse = o.inverse_depth + from, * __restrict depth = o.depth_mm + from;
  float* __restrict sigma_mm = o.sigma_mm + from, * __restrict wrapped = o.phase_rad + from;
  float* __restrict x_mm = o.x_mm + from, * __restrict y_mm = o.y_mm + from;
  const std::int32_t* __restrict wraps = s.wraps.data();
  std::int32_t* __restrict reject = s.reject.data(), * __restrict order = s.order.data();
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < count; ++u) {
    const float raw = phase[u] - ripple_error(ripple, cosine[u], sine[u]);
    const int wrap_counts = wraps[u] + static_cast<int>(raw >= kPiF) - static_cast<int>(raw < -kPiF);
    const float phi = select(raw >= kPiF, raw - kTwoPiF, select(raw < -kPiF, raw + kTwoPiF, raw));
    const float absolute = phi + kTwoPiF * static_cast<float>(wrap_counts);
    const float t = absolute - mid[u];
    const float q = c0[u] + t * (c1[u] + t * (c2[u] + t * c3[u]));
    const float slope = c1[u] + t * (2 * c2[u] + t * (3 * c3[u]));
    const bool inside =
        (q <= range.q_near) & (q >= range.q_far) & (absolute > range.phase_low_rad) & (absolute < range.phase_high_rad);
    const int was = reject[u];
    const bool placed = was == 0, ok = inside & placed;
    const float z = 1.0F / select(ok, q, kNan);
    inverse[u] = select(ok, q, kNan);
    depth[u] = z;
    sigma_mm[u] = select(ok, z * z * std::abs(slope) * sigma[u], kNan);
    x_mm[u] = ray_x[u] * z;
    y_mm[u] = ray_y[u] * z;
    const bool beyond = placed & !inside;
    reject[u] = beyond ? static_cast<int>(PixelReject::kOutOfRange) : was;
    const float three_frames = select(phase[u] >= kPiF, -kPiF, phase[u]);
    const bool unlit = (was >= kDark) & (was <= kNoisy);
    wrapped[u] = select(unlit, kNan, select(placed, phi, three_frames));
    const int floor_order = wrap_counts - static_cast<int>(phi < 0);
    const bool known = ok & (floor_order >= 0) & (floor_order < static_cast<int>(kNoOrder));
    order[u] = known ? floor_order : static_cast<int>(kNoOrder);
  }
}

void surface_loop(const SurfaceRow& row, const InverseDepthRange& limits, const RippleTerms& terms, std::size_t width,
                  const SurfaceRowOut& o) {
  Stretch stretch;
  for (std::size_t from = 0; from < width; from += kStretch) {
    const std::size_t count = std::min(kStretch, width - from);
    widen(row.wraps + from, row.reject + from, count, stretch);
    surface_stretch(row, limits, terms, from, count, o, stretch);
    narrow(stretch, count, o.reject + from, o.order + from);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(surface_loop);

void solve_surface_row(const SurfaceRow& row, const InverseDepthRange& range, const RippleTerms& ripple,
                       std::size_t width, const SurfaceRowOut& out) {
  HWY_DYNAMIC_DISPATCH(surface_loop)(row, range, ripple, width, out);
}

}  // namespace enamel::pipeline
#endif
