#include "tests/support/four_step.hpp"

#include <array>
#include <cmath>
#include <cstring>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/support/four_step.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::test::HWY_NAMESPACE {

using namespace pipeline;

// Highway's own operations here: the loop is short enough for what compilers add to it to count. Products and sums fuse
// by name and on every target, so that the bits are the same.
namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;
constexpr Floats kFloats;

[[gnu::always_inline]] inline Vector all(float value) { return hn::Set(kFloats, value); }

/// a b + c, rounded once.
[[gnu::always_inline]] inline Vector fused(Vector a, Vector b, Vector c) {
#if HWY_NATIVE_FMA
  return hn::MulAdd(a, b, c);
#else
  std::array<float, hn::MaxLanes(kFloats)> x, y, z;
  hn::StoreU(a, kFloats, x.data()), hn::StoreU(b, kFloats, y.data()), hn::StoreU(c, kFloats, z.data());
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::fma(x[k], y[k], z[k]);
  return hn::LoadU(kFloats, x.data());
#endif
}

/// minuend - subtrahend, exact.
template <class Pixel>
[[gnu::always_inline]] inline Vector difference(const std::uint8_t* minuend, const std::uint8_t* subtrahend,
                                                std::size_t at) {
  constexpr hn::Rebind<Pixel, Floats> kPixels;
  constexpr hn::Rebind<std::int32_t, Floats> kWide;
  std::array<Pixel, hn::MaxLanes(kFloats)> more, less;
  std::memcpy(more.data(), minuend + at * sizeof(Pixel), sizeof more);
  std::memcpy(less.data(), subtrahend + at * sizeof(Pixel), sizeof less);
  return hn::ConvertTo(kFloats, hn::Sub(hn::PromoteTo(kWide, hn::LoadU(kPixels, more.data())),
                                        hn::PromoteTo(kWide, hn::LoadU(kPixels, less.data()))));
}

/// Of q in [0, 1]: minimax odd polynomial of degree 13, error <= 7e-7 rad (tested).
[[gnu::always_inline]] inline Vector arctangent(Vector q) {
  const Vector s = hn::Mul(q, q);
  Vector p = fused(all(0.006811792962253094F), s, all(-0.0336042195558548F));
  p = fused(p, s, all(0.07962366938591003F));
  p = fused(p, s, all(-0.1323334276676178F));
  p = fused(p, s, all(0.19807815551757812F));
  p = fused(p, s, all(-0.3331736922264099F));
  p = fused(p, s, all(0.9999961256980896F));
  return hn::Mul(p, q);
}

template <class Pixel>
[[gnu::always_inline]] inline void solve_vector(const std::array<const std::uint8_t*, 4>& frames, std::size_t at,
                                                float* phase_rad, float* modulation_dn) {
  const Vector sine = difference<Pixel>(frames[3], frames[1], at);
  const Vector cosine = difference<Pixel>(frames[0], frames[2], at);
  const Vector height = hn::Abs(sine), width = hn::Abs(cosine), larger = hn::Max(height, width);
  Vector angle = arctangent(hn::Div(hn::Min(height, width), hn::Max(larger, all(1e-30F))));
  angle = hn::IfThenElse(hn::Gt(height, width), hn::Sub(all(0.5F * kPiF), angle), angle);
  angle = hn::IfThenElse(hn::Lt(cosine, hn::Zero(kFloats)), hn::Sub(all(kPiF), angle), angle);
  hn::StoreU(hn::CopySignToAbs(angle, sine), kFloats, phase_rad + at);
  const Vector modulation = hn::Sqrt(fused(cosine, cosine, hn::Mul(sine, sine)));
  hn::StoreU(hn::Mul(all(0.5F), modulation), kFloats, modulation_dn + at);
}

template <class Pixel>
[[gnu::always_inline]] inline void solve_pixels(std::array<const std::uint8_t*, 4> frames, std::size_t size,
                                                float* phase_rad, float* modulation_dn) {
  constexpr std::size_t kLanes = hn::MaxLanes(kFloats);
  if (size < kLanes) {
    std::array<std::array<std::uint8_t, kLanes * sizeof(Pixel)>, 4> few{};
    std::array<float, kLanes> phase, modulation;
    for (std::size_t k = 0; k < 4; ++k) {
      std::memcpy(few[k].data(), frames[k], size * sizeof(Pixel));
      frames[k] = few[k].data();
    }
    solve_vector<Pixel>(frames, 0, phase.data(), modulation.data());
    std::memcpy(phase_rad, phase.data(), size * sizeof(float));
    std::memcpy(modulation_dn, modulation.data(), size * sizeof(float));
    return;
  }
  for (std::size_t at = 0; at + kLanes <= size; at += kLanes) solve_vector<Pixel>(frames, at, phase_rad, modulation_dn);
  solve_vector<Pixel>(frames, size - kLanes, phase_rad, modulation_dn);  // again, or the last few
}

void solve_textbook(const pipeline::BurstView& view, float* phase_rad, float* modulation_dn) {
  const auto size = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  const std::array frames{view.frames[0].data(), view.frames[1].data(), view.frames[2].data(), view.frames[3].data()};
  if (view.bit_depth == 8) {
    solve_pixels<std::uint8_t>(frames, size, phase_rad, modulation_dn);
  } else {
    solve_pixels<std::uint16_t>(frames, size, phase_rad, modulation_dn);
  }
}

}  // namespace enamel::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::test {

HWY_EXPORT(solve_textbook);

void four_step(const pipeline::BurstView& view, Map<float>& phase_rad, Map<float>& modulation_dn) {
  for (Map<float>* map : {&phase_rad, &modulation_dn}) {
    if (map->width() != view.width || map->height() != view.height) *map = Map<float>(view.width, view.height);
  }
  HWY_DYNAMIC_DISPATCH(solve_textbook)(view, phase_rad.pixels().data(), modulation_dn.pixels().data());
}

}  // namespace enamel::test
#endif
