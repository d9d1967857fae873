#include "pipeline/decode/mode_t/closure_gate_rows.hpp"

#include <cmath>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_t/closure_gate_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

ClosureCount closure_loop(const PhaseMaps& m, const NoiseModel& model, float tolerance, float sigmas, std::size_t at,
                          std::size_t width) {
  const NoiseModel noise = model;
  const float* __restrict d = &m.code_dn[at], * __restrict s = &m.sine_dn[at];
  const float* __restrict b = &m.modulation_dn[at], * __restrict a = &m.mean_dn[at];
  const PixelReject* __restrict reject = &m.reject[at];
  ClosureCount out;
  for (std::size_t u = 0; u < width; ++u) {
    const float gap = std::abs(std::abs(d[u]) - std::abs(s[u]));
    const float limit = tolerance * b[u] + sigmas * root(noise.variance(a[u]));
    const auto counted = static_cast<std::uint32_t>((reject[u] == PixelReject::kNone) & (d[u] == d[u]));
    out.seen += counted;
    out.fits += counted & static_cast<std::uint32_t>(gap < limit);
  }
  return out;
}

void odd_loop(const PhaseMaps& m, const RowErrors& errors, std::size_t at, std::size_t width, float* sums) {
  const float* __restrict c = &m.cosine_dn[at], * __restrict s = &m.sine_dn[at], * __restrict b = &m.modulation_dn[at];
  const float* __restrict r = &m.code_dn[at], * __restrict w = errors.weight, * __restrict e = errors.rate;
  const float* __restrict rho = errors.harmonic, * __restrict light = errors.light, * __restrict mean = &m.mean_dn[at];
  const float black_dn = errors.black_dn;
  const PixelReject* __restrict reject = &m.reject[at];
  float* __restrict both = sums, * __restrict both_energy = both + width;
  float* __restrict level = both_energy + width, * __restrict level_energy = level + width;
  float* __restrict step = level_energy + width, * __restrict step_light = step + width;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const bool used = (std::abs(w[u]) > 0.999F) & (r[u] == r[u]) & (reject[u] == PixelReject::kNone);
    const bool plus = used & (w[u] > 0), minus = used & (w[u] < 0);
    const float passing = 2 * (mean[u] - black_dn) * light[u], sum = s[u] + c[u];
    const float of_plus = 2 * e[u] * (1 + e[u]) * (s[u] - c[u]) + 4 * rho[u] * (c[u] - s[u]) * sum / b[u] - passing;
    const float of_minus = -2 * e[u] * (c[u] - e[u] * s[u]) + passing;
    both[u] += select(plus, (r[u] - of_plus) * sum, 0);
    both_energy[u] += select(plus, sum * sum, 0);
    level[u] += select(minus, r[u] - of_minus, 0);
    level_energy[u] += select(minus, b[u], 0);
    step[u] += select(plus, r[u] - of_plus, 0);
    step_light[u] += select(plus, mean[u] - black_dn, 0);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(closure_loop);
HWY_EXPORT(odd_loop);

ClosureCount count_closure_row(const PhaseMaps& maps, const NoiseModel& noise, float tolerance, float sigmas,
                               std::size_t at, std::size_t width) {
  return HWY_DYNAMIC_DISPATCH(closure_loop)(maps, noise, tolerance, sigmas, at, width);
}

void add_odd_row(const PhaseMaps& maps, const RowErrors& errors, std::size_t at, std::size_t width, float* sums) {
  HWY_DYNAMIC_DISPATCH(odd_loop)(maps, errors, at, width, sums);
}

}  // namespace enamel::pipeline
#endif
