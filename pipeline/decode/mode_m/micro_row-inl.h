// A row of a mode M burst as its loops read it; compiled once per instruction set. Private to pipeline/decode/mode_m.
#if defined(ENAMEL_MICRO_ROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENAMEL_MICRO_ROW_INL_H_
#undef ENAMEL_MICRO_ROW_INL_H_
#else
#define ENAMEL_MICRO_ROW_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>

#include "pipeline/decode/mode_m/micro_pixel.hpp"
#include "pipeline/decode/mode_m/micro_refit_rows.hpp"

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// derived: variance of R over that of a frame: the code frame, A/3, and 2/3 each of the parts of B cos and B sin, on
/// average: 1 + 1/3 + 1/3 (1 + r^2) with r = 1 + 1/7.
constexpr float kResidualVariance = 2.1F;

/// A row's pixels, in each loop's own copy, which cannot alias what it writes.
struct Row {
  const float *mean, *cosine, *sine, *code, *modulation, *phase;
  const float *rate, *gain, *light, *rate_change, *light_change;
  const float* wraps;
  float black_dn;
  CodeWave wave;

  explicit Row(const CodeRow& r)
      : mean(r.pixels.mean),
        cosine(r.pixels.cosine),
        sine(r.pixels.sine),
        code(r.pixels.code),
        modulation(r.pixels.modulation),
        phase(r.pixels.phase),
        rate(r.motion_rad),
        gain(r.gain),
        light(r.light),
        rate_change(r.motion_change_rad),
        light_change(r.light_change),
        wraps(r.wraps),
        black_dn(r.black_dn),
        wave{r.inverse_ratio, r.harmonic} {}

  [[nodiscard, gnu::always_inline]] Pixel raw(std::size_t u) const { return {mean[u] - black_dn, cosine[u], sine[u]}; }
  template <bool kSteady>
  [[nodiscard, gnu::always_inline]] PixelChange change(std::size_t u) const {
    if constexpr (kSteady) return {rate[u], 0, 0, 0};
    return {rate[u], rate_change[u], light[u], light_change[u]};
  }
  [[nodiscard, gnu::always_inline]] bool placed(std::size_t u) const { return wraps[u] > kUnplaced; }
  template <bool kSteady>
  [[nodiscard, gnu::always_inline]] Residual residual(std::size_t u) const {
    return code_residual<kSteady>(raw(u), code[u], phase[u], wraps[u], change<kSteady>(u), gain[u], wave);
  }
};

/// Pixels begin ... end-1 of a row.
struct PixelRange {
  std::size_t begin, end;
};

/// Whether a pixel of them has more turns than `least`, which is kUnplaced or kNoSurface.
[[gnu::always_inline]] inline bool has_surface(const float* wraps, float least, PixelRange of) {
  std::int32_t found = 0;
  for (std::size_t u = of.begin; u < of.end; ++u) found |= static_cast<std::int32_t>(wraps[u] > least);
  return found != 0;
}

/// The next stretches of a row from `from` on that have_surface, one after the other; none: empty, at the row's end.
[[gnu::always_inline]] inline PixelRange next_surface(const float* wraps, float least, std::size_t from,
                                                      std::size_t width) {
  constexpr std::size_t kStretch = 32;  // layout: pixels that are looked at together
  const auto stretch = [width](std::size_t u) { return PixelRange{u, u + kStretch < width ? u + kStretch : width}; };
  while (from < width && !has_surface(wraps, least, stretch(from))) from = stretch(from).end;
  std::size_t end = from;
  while (end < width && has_surface(wraps, least, stretch(end))) end = stretch(end).end;
  return {from, end};
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
