#include "pipeline/decode/mode_t/flip_rows.hpp"

#include <cmath>

#include "pipeline/decode/mode_t/chosen.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_t/flip_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

constexpr float kFull = 0.999F;  ///< layout: 1 less rounding; weights above it are those of pixels away from flips

/// B sin of the phase at frame 3's exposure, from what three frames made of it, to second order in eps.
[[gnu::always_inline]] inline float sine_of_frame3(float c, float s3, float eps) {
  return s3 * (1 - eps - eps * eps) + 2 * eps * c;
}

/// Angle of the vector (x, y), by the first of its continued fraction: to 1e-4 rad up to 0.5 rad, x > 0.
[[gnu::always_inline]] inline float small_angle(float y, float x) {
  const float x2 = x * x, y2 = y * y;
  return y * (15 * x2 + 4 * y2) / (x * (15 * x2 + 9 * y2) + 1e-6F);
}

void flip_loop(const PhaseMaps& m, const RowErrors& errors, std::size_t at, std::size_t width, float* sums) {
  const float* __restrict c = &m.cosine_dn[at], * __restrict s = &m.sine_dn[at], * __restrict b = &m.modulation_dn[at];
  const float* __restrict r = &m.code_dn[at], * __restrict w = errors.weight, * __restrict e = errors.rate;
  const float* __restrict rho = errors.harmonic, * __restrict light = errors.light, * __restrict mean = &m.mean_dn[at];
  const float* __restrict sigma = &m.sigma_rad[at];
  const PixelReject* __restrict reject = &m.reject[at];
  const float black_dn = errors.black_dn;
  float* __restrict rounding = sums, * __restrict modulation = rounding + width;
  float* __restrict noise = modulation + width, * __restrict pixels = noise + width;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const bool plus = std::copysign(1.0F, w[u]) > 0;
    // closure.hpp, with eps to second order in what three frames measured.
    const float s3 = s[u] + 0.5F * std::abs(w[u]) * select(r[u] == r[u], r[u], 0), own = mean[u] - black_dn;
    const float of_plus = 2 * e[u] * (s3 - c[u]) + 4 * rho[u] * (c[u] - s3) * (c[u] + s3) / (b[u] + 1e-6F) -
                          2 * light[u] * (own + c[u] + s3);
    const float of_minus = -2 * e[u] * (c[u] - e[u] * s3) + 2 * light[u] * (own - s3);
    const float rest = r[u] - select(plus, of_plus, of_minus);
    const float near = std::abs(w[u]), size = std::abs(rest);
    const bool used = (near < kFull) & (size < kMostFlipResidual * b[u]) & (reject[u] == PixelReject::kNone);
    const float side = std::copysign(1.0F, s3), at_frame3 = sine_of_frame3(c[u], s3, e[u]);
    rounding[u] += select(used, side * (at_frame3 - rest) - std::abs(at_frame3), 0);
    modulation[u] += select(used, b[u], 0);
    noise[u] += select(used, b[u] * sigma[u] * sigma[u], 0);
    pixels[u] += select(used, 1, 0);
  }
}

void rejoin_loop(const FlipRow& flips, const NoiseModel& model, std::size_t at, std::size_t width, PhaseMaps& m,
                 float* weights) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const float drop = flips.drop_sigmas, ramp = 1.0F / (flips.full_sigmas - flips.drop_sigmas);
  const float* __restrict blur = flips.sigma_rad, * __restrict rate = flips.motion_rad, * __restrict mean = &m.mean_dn[at];
  const float* __restrict cosine = &m.cosine_dn[at], * __restrict modulation = &m.modulation_dn[at];
  const PixelReject* __restrict reject = &m.reject[at];
  float* __restrict residual = &m.code_dn[at];
  float* __restrict sine = &m.sine_dn[at], * __restrict phase = &m.phase_rad[at], * __restrict sigma = &m.sigma_rad[at];
  float* __restrict weight = weights;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float a = mean[u], c = cosine[u], was = sine[u], old = std::abs(weight[u]),
                b = std::copysign(1.0F, weight[u]);
    const bool asked = (old < kFull) & (residual[u] == residual[u]) & (reject[u] == PixelReject::kNone);
    const float seen = select(asked, residual[u], 0);
    const float s3 = was + 0.5F * old * seen;
    // A flip lies where sin phi = 0; the sine of the distance serves as the distance, which it is below by 8 % at most.
    // Where motion carries the pixel across the flip before frame 3, it is negative.
    const float width_dn = modulation[u] * blur[u];
    const float off = std::copysign(1.0F, s3) * sine_of_frame3(c, s3, rate[u]) / width_dn;
    const float near = smaller(larger((off - drop) * ramp, 0), 1), w = select(asked, larger(near, old), old);
    const float rest = larger(1 - 0.25F * larger(off, 0), 0), rest2 = rest * rest;
    const float rounding = rest2 * rest2 * rest * (0.20447583F + 0.66232246F * rest);
    const float r = seen + select(asked, std::copysign(width_dn * rounding, s3), 0);
    const float s = s3 - 0.5F * w * r, bd = s3 - seen;
    const float g = 1 - 0.5F * w * (1 + b);
    const float e0 = 0.5F * (c * g - s), e2 = 0.5F * (c * g + s), e1 = c * (1 - 0.5F * w), e3 = 0.5F * c * w;
    const float variance_b4 = e0 * e0 * noise.variance(a + c) + e2 * e2 * noise.variance(a - c) +
                              e1 * e1 * noise.variance(a - s3) + e3 * e3 * noise.variance(a + b * bd);
    const float now = root(variance_b4 + 1e-12F) / (c * c + s * s + 1e-6F);
    const float turned = small_angle(s * c - c * was, c * c + s * was);
    sine[u] = select(asked, s, was);
    phase[u] = phase[u] + select(asked, turned, 0);
    sigma[u] = select(asked, now, sigma[u]);
    residual[u] = select(asked, r, residual[u]);
    weight[u] = select(asked, b * w, weight[u]);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(flip_loop);
HWY_EXPORT(rejoin_loop);

void add_flip_row(const PhaseMaps& m, const RowErrors& e, std::size_t at, std::size_t width, float* sums) {
  HWY_DYNAMIC_DISPATCH(flip_loop)(m, e, at, width, sums);
}

void rejoin_flip_row(const FlipRow& row, const NoiseModel& noise, std::size_t at, std::size_t width, PhaseMaps& maps,
                     Map<float>& weight) {
  HWY_DYNAMIC_DISPATCH(rejoin_loop)(row, noise, at, width, maps, &weight[at]);
}

}  // namespace enamel::pipeline
#endif
