#include "pipeline/decode/mode_m/micro_light_rows.hpp"

#include "pipeline/decode/mode_m/micro_pixel.hpp"
#include "pipeline/decode/phase/polar_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_m/micro_light_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "pipeline/decode/mode_m/micro_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// derived: variance of B over that of a frame.
constexpr float kFringeVariance = 2.0F / 3;

template <bool kSteady>
void light_pixels(const CodeRow& in, const NoiseModel& model, float limit, std::size_t width, const LightRow& out) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const Row row(in);
  float* __restrict light = out.light, * __restrict cosine = out.cosine, * __restrict sine = out.sine;
  float* __restrict rest = out.rest, * __restrict by_cosine = out.rest_by_cosine, * __restrict by_sine = out.rest_by_sine;
  float* __restrict by_gain = out.rest_by_gain, * __restrict weight = out.weight, * __restrict sure = out.rest_weight;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const PixelChange d = row.change<kSteady>(u);
    const Pixel raw = row.raw(u), p = at_mid_burst(raw, lights_of<kSteady>(d), turns_of<kSteady>(d));
    const Residual k = row.residual<kSteady>(u);
    const float in_b = 1 / root(p.cosine * p.cosine + p.sine * p.sine + 1e-6F), gain = row.gain[u];
    const float turned = kSteady ? kCodeTime * d.rate : d.turned(kCodeTime);
    const CodeModel model_of =
        code_model(row.wraps[u], row.phase[u] + ahead(raw, p), (1 + row.wave.inverse_ratio) * turned, row.wave);
    const float c = p.cosine * in_b, s = p.sine * in_b;
    light[u] = p.mean, cosine[u] = p.cosine, sine[u] = p.sine;
    rest[u] = k.rest;
    // The code frame's angle is ahead of the phase by delta: its prediction is g (C cos delta - S sin delta).
    by_cosine[u] = -gain * (model_of.angle.cos * c + model_of.angle.sin * s);
    by_sine[u] = gain * (model_of.angle.sin * c - model_of.angle.cos * s);
    by_gain[u] = -k.by_gain;
    const bool inside = (row.wraps[u] > kNoSurface) & (p.mean > 1);
    const bool placed = row.placed(u), close = std::abs(k.rest) < limit * k.modulation;  // false for NaN
    const bool known = close & placed & inside;
    const float inverse = 1 / noise.variance(row.mean[u]);
    weight[u] = select(inside, inverse / kFringeVariance, 0);
    sure[u] = select(known, inverse / kResidualVariance, 0);
  }
}

void light_loop(const CodeRow& row, const NoiseModel& noise, float limit, std::size_t width, const LightRow& out) {
  (row.steady ? light_pixels<true> : light_pixels<false>)(row, noise, limit, width, out);
}

void take_off_loop(const LightShares& shares, float black_dn, std::size_t width, const MovedRow& out) {
  const float *of_cosine = shares.cosine, *of_sine = shares.sine, *of_code = shares.rest;
  float *mean = out.mean, *cosine = out.cosine, *sine = out.sine, *code = out.code;
  float *modulation = out.modulation, *phase = out.phase;
  const bool even = shares.of == LampLight::kEven;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float light = larger(mean[u] - black_dn, 0);
    const Pixel was{light, cosine[u], sine[u]};
    const float base = even ? kEvenLight_dn : light;
    const Pixel now{light, was.cosine - of_cosine[u] * base, was.sine - of_sine[u] * base};
    phase[u] += ahead(was, now);
    cosine[u] = now.cosine, sine[u] = now.sine;
    code[u] -= of_code[u] * base;
    modulation[u] = root(now.cosine * now.cosine + now.sine * now.sine + 1e-6F);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(light_loop);
HWY_EXPORT(take_off_loop);

void micro_light_row(const CodeRow& row, const NoiseModel& noise, float max_residual, std::size_t width,
                     const LightRow& out) {
  HWY_DYNAMIC_DISPATCH(light_loop)(row, noise, max_residual, width, out);
}

void take_light_off_row(const LightShares& shares, float black_dn, std::size_t width, const MovedRow& out) {
  HWY_DYNAMIC_DISPATCH(take_off_loop)(shares, black_dn, width, out);
}

}  // namespace enamel::pipeline
#endif
