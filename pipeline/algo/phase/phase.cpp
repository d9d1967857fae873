#include "pipeline/algo/phase/phase.hpp"

#include <limits>

#include "pipeline/algo/phase/frame_rows.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

struct RowOut {
  float* mean;
  float* cosine;
  float* sine;
  float* code;
  float* modulation;
  float* phase;
  float* sigma;
};

void solve_row(const FrameRows& rows, std::size_t width, const NoiseModel noise, float saturated_dn, const RowOut& o) {
  const float* __restrict i0 = rows[0].data();
  const float* __restrict i1 = rows[1].data();
  const float* __restrict i2 = rows[2].data();
  const float* __restrict i3 = rows[3].data();
  float* __restrict mean = o.mean, * __restrict cosine = o.cosine, * __restrict sine = o.sine, * __restrict code = o.code;
  float* __restrict modulation = o.modulation, * __restrict phase = o.phase, * __restrict sigma = o.sigma;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float a = 0.5F * (i0[u] + i2[u]);
    const float c = 0.5F * (i0[u] - i2[u]);
    const float s = a - i1[u];
    const float b2 = c * c + s * s + 1e-6F;
    // First-order propagation of the three frames' noise through atan2(s, c).
    const float e0 = 0.5F * (c - s), e2 = 0.5F * (c + s);
    const float var = e0 * e0 * noise.variance(i0[u]) + e2 * e2 * noise.variance(i2[u]) + c * c * noise.variance(i1[u]);
    mean[u] = a;
    cosine[u] = c;
    sine[u] = s;
    code[u] = select(i3[u] < saturated_dn, i3[u] - a, std::numeric_limits<float>::quiet_NaN());
    modulation[u] = root(b2);
    phase[u] = atan2_poly(s, c);
    sigma[u] = root(var) / b2;
  }
}

}  // namespace

void PhaseMaps::resize(int width, int height) {
  if (mean_dn.width() == width && mean_dn.height() == height) return;
  for (Map<float>* map : {&mean_dn, &cosine_dn, &sine_dn, &code_dn, &modulation_dn, &phase_rad, &sigma_rad})
    *map = Map<float>(width, height);
  reject = Map<PixelReject>(width, height);
}

void compute_phase(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps) {
  maps.resize(view.width, view.height);
  const auto width = static_cast<std::size_t>(view.width);
  FrameRows rows;
  for (auto& row : rows) row.resize(width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(view.height); ++v) {
    load_row(view, v, rows);
    const std::size_t at = v * width;
    solve_row(rows, width, noise, config.saturation * noise.full_scale_dn,
              {&maps.mean_dn[at], &maps.cosine_dn[at], &maps.sine_dn[at], &maps.code_dn[at], &maps.modulation_dn[at],
               &maps.phase_rad[at], &maps.sigma_rad[at]});
    mask_row({rows[0].data(), rows[1].data(), rows[2].data()}, width, noise, config, &maps.sigma_rad[at],
             &maps.reject[at]);
  }
}

}  // namespace enamel::algo
