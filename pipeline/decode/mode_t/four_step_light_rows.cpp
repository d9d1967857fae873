#include "pipeline/decode/mode_t/four_step_light_rows.hpp"

#include "pipeline/decode/mode_t/chosen.hpp"
#include "pipeline/decode/mode_t/frame_solve.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_t/four_step_light_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// derived: variance over that of a frame, the mean over a fringe: of B, with 1/2 of C and 3/2 of S; of what frame 3
/// shows beyond A + b S: 4 where b = +1, else 2.
constexpr float kFringeVariance = 1, kRestVariance = 4;

void light_loop(const PixelRow& in, const PixelReject* of_row, const NoiseModel& model, float limit, std::size_t width,
                const LightRow& out) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const float* __restrict c = in.cosine, * __restrict s = in.sine, * __restrict r = in.code, * __restrict mean = in.mean;
  const float* __restrict w = in.errors.weight, * __restrict rate = in.errors.rate, * __restrict rho = in.errors.harmonic;
  const float* __restrict growth = in.errors.light, * __restrict rate_change = in.errors.rate_change;
  const float* __restrict growth_change = in.errors.light_change;
  const PixelReject* __restrict reject = of_row;
  const float black_dn = in.errors.black_dn, full = kBrightest * model.full_scale_dn - black_dn;
  float* __restrict light = out.light, * __restrict cosine = out.cosine, * __restrict sine = out.sine;
  float* __restrict rest = out.rest, * __restrict by_sine = out.rest_by_sine, * __restrict by_gain = out.rest_by_gain;
  float* __restrict weight = out.weight, * __restrict sure = out.rest_weight;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const PixelChange d{rate[u], rate_change[u], growth[u], growth_change[u]};
    const Turns turns = turns_of<false>(d);
    const float a = mean[u] - black_dn, b = std::copysign(1.0F, w[u]), s3 = sine_of_three(s[u], w[u], r[u]);
    const float seen = select(r[u] == r[u], r[u], 0);
    const FourFrames x{(a + c[u]) / d.light(-1.5F), (a - s3) / d.light(-0.5F), (a - c[u]) / d.light(0.5F),
                       (a + b * (s3 - seen)) / d.light(1.5F)};
    const FourStepPixel p = solve_first_three(x, turns);
    const FourFrames h = harmonic_of(p, turns);
    const FourStepPixel of_h = solve_first_three(h, turns);
    const float lit = p.mean - rho[u] * of_h.mean, cos = p.cosine - rho[u] * of_h.cosine,
                sin = p.sine - rho[u] * of_h.sine;
    const float fringe = sin * turns.a3.cos + cos * turns.a3.sin;
    const float off = x.x3 - rho[u] * h.x3 - lit - b * fringe, modulation = root(cos * cos + sin * sin + 1e-6F);
    light[u] = lit, cosine[u] = cos, sine[u] = sin, rest[u] = off;
    by_sine[u] = -b, by_gain[u] = b * fringe;
    const bool inside =
        ((w[u] != 0) | (r[u] == r[u])) & (reject[u] == PixelReject::kNone) & (lit > 1) & (a + modulation < full);
    const float decided = std::abs(w[u]), apart = std::abs(off);
    const bool known = inside & (decided > 0.999F) & (r[u] == r[u]) & (apart < limit * modulation);
    const float inverse = 1 / noise.variance(mean[u]);
    weight[u] = select(inside, inverse / kFringeVariance, 0);
    sure[u] = select(known, inverse / kRestVariance, 0);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(light_loop);

void four_step_light_row(const PixelRow& row, const PixelReject* reject, const NoiseModel& noise, float max_residual,
                         std::size_t width, const LightRow& out) {
  HWY_DYNAMIC_DISPATCH(light_loop)(row, reject, noise, max_residual, width, out);
}

}  // namespace enamel::pipeline
#endif
