#include "pipeline/decode/steps/sight_rows.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/steps/sight_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// derived: C and S3 each have the variance 2/3 sigma^2 of three frames, and B^2 is the sum of their squares.
constexpr float kNoiseOfFringe2 = 4.0F / 3;

/// layout: of a row, so many pixels at a time: their reasons are widened before, as in surface_rows.cpp.
constexpr std::size_t kSightStretch = 256;
using SightReasons = std::array<std::int32_t, kSightStretch>;

void sight_stretch(const PhaseMaps& m, const NoiseModel& model, const SightReasons& reasons, std::size_t at,
                   std::size_t count, std::size_t width, float* sums) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const std::int32_t* __restrict reason = reasons.data();
  const float* __restrict cosine = &m.cosine_dn[at], * __restrict sine = &m.sine_dn[at], * __restrict mean = &m.mean_dn[at];
  const auto of = [&](SightSum k) { return sums + k * width; };
  float* __restrict measured = of(kMeasured), * __restrict saturated = of(kSaturated), * __restrict light = of(kLight);
  float* __restrict fringe2 = of(kFringe2), * __restrict noise2 = of(kNoise2), * __restrict lit = of(kLit);
  float* __restrict lit_cosine = of(kLitCosine), * __restrict lit_sine = of(kLitSine), * __restrict lit_light = of(kLitLight);
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < count; ++u) {
    const bool known = reason[u] != static_cast<std::int32_t>(PixelReject::kSaturated);
    const bool shines = known & (reason[u] != static_cast<std::int32_t>(PixelReject::kDark));
    const float c = cosine[u], s = sine[u], a = mean[u] - noise.black_dn;
    measured[u] += select(known, 1, 0);
    saturated[u] += select(known, 0, 1);
    light[u] += select(known, a, 0);
    fringe2[u] += select(known, c * c + s * s, 0);
    noise2[u] += select(known, kNoiseOfFringe2 * noise.variance(mean[u]), 0);
    lit[u] += select(shines, 1, 0);
    lit_cosine[u] += select(shines, c, 0);
    lit_sine[u] += select(shines, s, 0);
    lit_light[u] += select(shines, a, 0);
  }
}

void sight_loop(const PhaseMaps& m, const NoiseModel& noise, std::size_t at, std::size_t width, float* sums) {
  SightReasons reasons;
  for (std::size_t from = 0; from < width; from += kSightStretch) {
    const std::size_t count = std::min(kSightStretch, width - from);
    const PixelReject* __restrict reject = &m.reject[at + from];
    std::int32_t* __restrict wide = reasons.data();
    for (std::size_t u = 0; u < count; ++u) wide[u] = static_cast<std::int32_t>(reject[u]);
    sight_stretch(m, noise, reasons, at + from, count, width, sums + from);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(sight_loop);

void add_sight_row(const PhaseMaps& maps, const NoiseModel& noise, std::size_t at, std::size_t width, float* sums) {
  HWY_DYNAMIC_DISPATCH(sight_loop)(maps, noise, at, width, sums);
}

}  // namespace enamel::pipeline
#endif
