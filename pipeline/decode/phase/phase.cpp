#include "pipeline/decode/phase/phase.hpp"

#include "pipeline/decode/phase/frame_rows.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/phase/phase.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void solve_four_step(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps) {
  solve_burst(view, noise, config, {0, 1, 2, 3}, maps, [](float i0, float i1, float i2, const NoiseModel& n) {
    const float a = 0.5F * (i0 + i2);
    const float c = 0.5F * (i0 - i2);
    const float s = a - i1;
    // First-order propagation of the three frames' noise through atan2(s, c).
    const float e0 = 0.5F * (c - s), e2 = 0.5F * (c + s);
    return ThreeFrames{a, c, s, e0 * e0 * n.variance(i0) + e2 * e2 * n.variance(i2) + c * c * n.variance(i1)};
  });
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(solve_four_step);

void compute_phase(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps) {
  HWY_DYNAMIC_DISPATCH(solve_four_step)(view, noise, config, maps);
}

void PhaseMaps::resize(int width, int height) {
  if (mean_dn.width() == width && mean_dn.height() == height) return;
  for (Map<float>* map : {&mean_dn, &cosine_dn, &sine_dn, &code_dn, &modulation_dn, &phase_rad, &sigma_rad})
    *map = Map<float>(width, height);
  reject = Map<PixelReject>(width, height);
}

}  // namespace enamel::pipeline
#endif
