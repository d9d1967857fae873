#include "pipeline/decode/steps/frame_gate_rows.hpp"

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

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(repeats_loop);

RepeatCount count_repeats_row(const std::array<const float*, 4>& frames, const PhaseMaps& maps, const NoiseModel& noise,
                              float sigmas, std::size_t at, std::size_t width) {
  return HWY_DYNAMIC_DISPATCH(repeats_loop)(frames, maps, noise, sigmas, at, width);
}

}  // namespace enamel::pipeline
#endif
