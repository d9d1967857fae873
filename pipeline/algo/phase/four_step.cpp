#include "pipeline/algo/phase/four_step.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/phase/four_step.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

constexpr std::size_t kStretch = 1024;  ///< pixels whose differences stay in the first-level cache
using Stretch = std::array<float, kStretch>;

template <class Pixel>
[[gnu::always_inline]] inline Pixel value_at(const std::uint8_t* frame, std::size_t i) {
  Pixel value;
  std::memcpy(&value, frame + i * sizeof value, sizeof value);
  return value;
}

template <class Pixel>
[[gnu::always_inline]] inline void differ(const std::uint8_t* minuend, const std::uint8_t* subtrahend, std::size_t at,
                                          std::size_t count, Stretch& difference) {
  float* __restrict out = difference.data();
  for (std::size_t u = 0; u < count; ++u) {
    const int more = value_at<Pixel>(minuend, at + u), less = value_at<Pixel>(subtrahend, at + u);
    out[u] = static_cast<float>(more - less);
  }
}

template <class Pixel>
[[gnu::always_inline]] inline void solve_pixels(const BurstView& view, float* phase_rad, float* modulation_dn) {
  const auto size = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  Stretch sine, cosine;
  for (std::size_t at = 0; at < size; at += kStretch) {
    const std::size_t count = std::min(kStretch, size - at);
    differ<Pixel>(view.frames[0].data(), view.frames[2].data(), at, count, cosine);
    differ<Pixel>(view.frames[3].data(), view.frames[1].data(), at, count, sine);
    const float* __restrict s = sine.data(), * __restrict c = cosine.data();
    float* __restrict phase = phase_rad + at, * __restrict modulation = modulation_dn + at;
    ENAMEL_INDEPENDENT
    for (std::size_t u = 0; u < count; ++u) {
      modulation[u] = 0.5F * root(c[u] * c[u] + s[u] * s[u]);
      phase[u] = atan2_pairs(s[u], c[u]);
    }
  }
}

void solve_textbook(const BurstView& view, float* phase_rad, float* modulation_dn) {
  if (view.bit_depth == 8) {
    solve_pixels<std::uint8_t>(view, phase_rad, modulation_dn);
  } else {
    solve_pixels<std::uint16_t>(view, phase_rad, modulation_dn);
  }
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(solve_textbook);

void four_step(const BurstView& view, Map<float>& phase_rad, Map<float>& modulation_dn) {
  for (Map<float>* map : {&phase_rad, &modulation_dn}) {
    if (map->width() != view.width || map->height() != view.height) *map = Map<float>(view.width, view.height);
  }
  HWY_DYNAMIC_DISPATCH(solve_textbook)(view, phase_rad.pixels().data(), modulation_dn.pixels().data());
}

}  // namespace enamel::algo
#endif
