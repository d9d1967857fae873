#include "pipeline/decode/steps/frame_gate_rows.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/steps/frame_gate_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

RepeatCount repeats_loop(const std::array<const float*, 4>& frames, const PhaseMaps& m, const NoiseModel& model,
                         float sigmas, std::size_t at, std::size_t width) {
  const NoiseModel noise = model;
  const float* __restrict i0 = frames[0], * __restrict i1 = frames[1];
  const float* __restrict i2 = frames[2], * __restrict i3 = frames[3];
  const float* __restrict mean = &m.mean_dn[at];
  const PixelReject* __restrict reject = &m.reject[at];
  const float squared = sigmas * sigmas;
  std::uint32_t seen = 0, s01 = 0, s02 = 0, s03 = 0, s12 = 0, s13 = 0, s23 = 0;
  for (std::size_t u = 0; u < width; ++u) {
    const auto counted = static_cast<std::uint32_t>(reject[u] == PixelReject::kNone);
    const float limit = squared * noise.variance(mean[u]);
    const auto alike = [limit, counted](float a, float b) {
      return counted & static_cast<std::uint32_t>((a - b) * (a - b) < limit);
    };
    seen += counted;
    s01 += alike(i0[u], i1[u]);
    s02 += alike(i0[u], i2[u]);
    s03 += alike(i0[u], i3[u]);
    s12 += alike(i1[u], i2[u]);
    s13 += alike(i1[u], i3[u]);
    s23 += alike(i2[u], i3[u]);
  }
  return {seen, {s01, s02, s03, s12, s13, s23}};
}

constexpr float kHalfPi = 1.5707964F;  ///< derived: erf(x/sqrt 2) is x/sqrt(x^2 + pi/2) to 0.06

/// layout: of a row, so many pixels at a time: their reasons are widened before, as in surface_rows.cpp.
constexpr std::size_t kPairStretch = 256;

void directions_loop(const PhaseMaps& m, const float* carrier_rad, std::size_t at, RowPairs pairs, float* sums) {
  std::array<std::int32_t, kPairStretch> open;
  const std::size_t width = pairs.width, apart = pairs.apart;
  for (std::size_t from = 0; from + apart < width; from += kPairStretch) {
    const std::size_t count = std::min(kPairStretch, width - apart - from);
    const PixelReject* __restrict reject = &m.reject[at + from];
    std::int32_t* __restrict valid = open.data();
    for (std::size_t u = 0; u < count; ++u)
      valid[u] =
          static_cast<int>(reject[u] == PixelReject::kNone) & static_cast<int>(reject[u + apart] == PixelReject::kNone);
    const float* __restrict p = &m.phase_rad[at + from], * __restrict sigma = &m.sigma_rad[at + from];
    const float* __restrict c = carrier_rad + at + from;
    float* __restrict follows = sums + from, * __restrict expected = sums + width + from;
    ENAMEL_INDEPENDENT
    for (std::size_t u = 0; u < count; ++u) {
      const bool counted = valid[u] != 0;
      const float step = c[u + apart] - c[u], noise2 = sigma[u] * sigma[u] + sigma[u + apart] * sigma[u + apart];
      const float kept = std::abs(step) / root(step * step + kHalfPi * noise2 + 1e-12F);  // of a sign, by noise
      const bool along = wrap_once(p[u + apart] - p[u]) * step > 0;
      follows[u] += select(counted, select(along, kept, -kept), 0);
      expected[u] += select(counted, kept * kept, 0);
    }
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(repeats_loop);
HWY_EXPORT(directions_loop);

RepeatCount count_repeats_row(const std::array<const float*, 4>& frames, const PhaseMaps& maps, const NoiseModel& noise,
                              float sigmas, std::size_t at, std::size_t width) {
  return HWY_DYNAMIC_DISPATCH(repeats_loop)(frames, maps, noise, sigmas, at, width);
}

void add_directions_row(const PhaseMaps& maps, const float* carrier_rad, std::size_t at, RowPairs pairs, float* sums) {
  HWY_DYNAMIC_DISPATCH(directions_loop)(maps, carrier_rad, at, pairs, sums);
}

}  // namespace enamel::pipeline
#endif
