#include "pipeline/algo/phase/closure_rows.hpp"

#include <cmath>

#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/phase/closure_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

void add_loop(const PhaseMaps& m, const PolarityMaps& p, std::size_t at, std::size_t width, float limit, float* sums) {
  const float* __restrict c = &m.cosine_dn[at], * __restrict s = &m.sine_dn[at], * __restrict b = &m.modulation_dn[at];
  const float* __restrict r = &m.code_dn[at], * __restrict w = &p.weight[at];
  float* __restrict s0 = sums, * __restrict s1 = s0 + width, * __restrict s2 = s1 + width;
  float* __restrict s3 = s2 + width, * __restrict s4 = s3 + width, * __restrict s5 = s4 + width;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float used = select(std::abs(w[u]) > 0.999F, 1, 0) * select(std::abs(r[u]) < limit * b[u], 1, 0);
    const float plus = select(w[u] > 0, used, 0);
    const float x1 = 2 * (s[u] * plus - c[u] * used);
    const float x2 = 4 * plus * (c[u] - s[u]) * (c[u] + s[u]) / (b[u] + 1e-6F);
    const float y = select(used > 0, r[u], 0);
    s0[u] += x1 * x1;
    s1[u] += x1 * x2;
    s2[u] += x2 * x2;
    s3[u] += x1 * y;
    s4[u] += x2 * y;
    s5[u] += used;
  }
}

void correct_loop(const PhaseMaps& m, const RowErrors& e, float black_dn, std::size_t at, std::size_t width,
                  float* phase) {
  const float* __restrict c = &m.cosine_dn[at], * __restrict s = &m.sine_dn[at], * __restrict b = &m.modulation_dn[at];
  const float* __restrict mean = &m.mean_dn[at], * __restrict w = e.weight, * __restrict em = e.rate;
  const float* __restrict rm = e.harmonic, * __restrict lm = e.light;
  float* __restrict out = phase;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float inv = 1.0F / (b[u] + 1e-6F);
    const float cs = c[u] * inv, sn = s[u] * inv;
    const float cos2 = (cs - sn) * (cs + sn), sin2 = 2 * cs * sn;
    const float h = 0.5F * em[u], ripple = 2 * rm[u] * cos2 * cs;
    const float a = lm[u], ak = a * b[u] / larger(mean[u] - black_dn, 1);
    const float three =
        ripple - (h * (1 - sin2) + h * h * (1 + cos2 - sin2)) * (1 - h * (1 + cos2)) + a * sn - ak * cs * cs;
    const float plus = h * cos2 * (1 + h * sin2) + a * (cs + sn) + 0.5F * ak * sin2;
    const float minus = ripple + (h * (sin2 + cos2) - h * h * (1 + cos2)) * (1 - h * (1 + cos2 - sin2)) +
                        a * (sn - cs) + ak * (0.5F * sin2 - cs * cs);
    const float with_code = select(w[u] > 0, plus, minus);
    out[u] -= three + std::abs(w[u]) * (with_code - three);
  }
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(add_loop);
HWY_EXPORT(correct_loop);

void add_closure_row(const PhaseMaps& m, const PolarityMaps& p, std::size_t at, std::size_t width, float limit,
                     float* sums) {
  HWY_DYNAMIC_DISPATCH(add_loop)(m, p, at, width, limit, sums);
}

void correct_phase_row(const PhaseMaps& m, const RowErrors& e, float black_dn, std::size_t at, std::size_t width,
                       float* phase) {
  HWY_DYNAMIC_DISPATCH(correct_loop)(m, e, black_dn, at, width, phase);
}

}  // namespace enamel::algo
#endif
