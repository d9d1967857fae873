#include "pipeline/decode/mode_t/closure_sample_rows.hpp"

#include <cmath>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_t/closure_sample_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void closure_loop(const SampledRow& in, float black_dn, float max_residual, const SampledResiduals& out) {
  const std::size_t count = in.count;
  const float* __restrict cosine = in.cosine, * __restrict sine = in.sine, * __restrict modulation = in.modulation;
  const float* __restrict mean = in.mean, * __restrict closure = in.code, * __restrict weights = in.weight;
  const float* __restrict open = in.open;
  float* __restrict rate = out.rate, * __restrict per_rate = out.rate_per_rate, * __restrict light = out.light;
  float* __restrict shared = out.shared, * __restrict residual = out.residual, * __restrict used = out.used;
  ENAMEL_INDEPENDENT
  for (std::size_t k = 0; k < count; ++k) {
    const float c = cosine[k], s = sine[k], b = modulation[k], r = closure[k], w = weights[k];
    const float sign = std::abs(w), off = std::abs(r);
    const bool asked = (open[k] > 0) & (sign > 0.999F) & (off < max_residual * b), plus = w > 0;
    const float own = mean[k] - black_dn;
    rate[k] = select(asked, select(plus, 2 * (s - c), -2 * c), 0);
    per_rate[k] = select(asked, select(plus, 2 * (s - c), 2 * s), 0);
    light[k] = select(asked, select(plus, -2 * (own + c + s), 2 * (own - s)), 0);
    shared[k] = select(asked & plus, 4 * (c - s) * (c + s) / (b + 1e-6F), 0);
    residual[k] = select(asked, r, 0);
    used[k] = select(asked, 1, 0);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(closure_loop);

void closure_sample_row(const SampledRow& pixels, float black_dn, float max_residual, const SampledResiduals& out) {
  HWY_DYNAMIC_DISPATCH(closure_loop)(pixels, black_dn, max_residual, out);
}

}  // namespace enamel::pipeline
#endif
