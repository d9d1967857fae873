#include "pipeline/algo/phase/frame_rows.hpp"
#include "pipeline/algo/phase/micro_phase.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/phase/micro_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

void solve_micro(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps) {
  constexpr float kThird = 1.0F / 3, kInvRoot3 = 0.57735027F;
  solve_burst(view, noise, config, {0, 2, 3, 1}, maps, [](float i0, float i2, float i3, const NoiseModel& n) {
    const float a = kThird * (i0 + i2 + i3);
    const float c = kThird * (2 * i0 - i2 - i3);
    const float s = kInvRoot3 * (i3 - i2);
    // First-order propagation of the three frames' noise through atan2(s, c).
    const float e0 = 2 * kThird * s, e2 = kThird * s - kInvRoot3 * c, e3 = kThird * s + kInvRoot3 * c;
    return ThreeFrames{a, c, s, e0 * e0 * n.variance(i0) + e2 * e2 * n.variance(i2) + e3 * e3 * n.variance(i3)};
  });
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(solve_micro);

void compute_micro_phase(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps) {
  HWY_DYNAMIC_DISPATCH(solve_micro)(view, noise, config, maps);
}

}  // namespace enamel::algo
#endif
