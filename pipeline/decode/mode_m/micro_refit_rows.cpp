#include "pipeline/decode/mode_m/micro_refit_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/mode_m/micro_pixel.hpp"
#include "pipeline/decode/phase/polar_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_m/micro_refit_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "pipeline/decode/mode_m/micro_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

template <bool kSteady>
void add_pixels(const Row& in, const NoiseModel& model, float limit, std::size_t width, PixelRange of, float* sums) {
  const NoiseModel noise = model;  // copies cannot alias what is written
  const Row row = in;
  float* __restrict s0 = sums, * __restrict s1 = s0 + width, * __restrict s2 = s1 + width;
  float* __restrict s3 = s2 + width, * __restrict s4 = s3 + width;
  ENAMEL_INDEPENDENT
  for (std::size_t u = of.begin; u < of.end; ++u) {
    const Residual k = row.residual<kSteady>(u);
    const bool placed = row.placed(u), used = (std::abs(k.rest) < limit * k.modulation) & placed;  // false for NaN
    const float w = select(used, 1 / (kResidualVariance * noise.variance(row.mean[u])), 0);
    const float r = select(used, k.rest, 0), of_gain = w * k.by_gain, of_motion = w * k.by_motion;
    s0[u] += of_gain * k.by_gain;
    s1[u] += of_gain * k.by_motion;
    s2[u] += of_motion * k.by_motion;
    s3[u] += of_gain * r;
    s4[u] += of_motion * r;
  }
}

void add_loop(const CodeRow& row, const NoiseModel& noise, float limit, std::size_t width, float* sums) {
  const auto add = row.steady ? add_pixels<true> : add_pixels<false>;
  for (PixelRange r = next_surface(row.wraps, kUnplaced, 0, width); r.begin < width;
       r = next_surface(row.wraps, kUnplaced, r.end, width))
    add(Row(row), noise, limit, width, r, sums);
}

template <bool kSteady>
void residuals(const Row& in, std::size_t count, const ResidualRow& out) {
  const Row row = in;
  float* __restrict rest = out.residual, * __restrict motion = out.by_motion;
  float* __restrict light = out.by_light, * __restrict growth = out.by_gain;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < count; ++u) {
    const Residual k = row.residual<kSteady>(u);
    rest[u] = select(row.placed(u), k.rest, std::numeric_limits<float>::quiet_NaN());
    motion[u] = -k.by_motion;
    light[u] = -k.by_light;
    growth[u] = -k.by_gain;
  }
}

void residual_loop(const CodeRow& row, std::size_t count, const ResidualRow& out) {
  (row.steady ? residuals<true> : residuals<false>)(Row(row), count, out);
}

template <bool kSteady>
void mid_burst(const Row& in, std::size_t count, float* phase_rad, float* light_dn) {
  const Row row = in;
  float* __restrict moved = phase_rad, * __restrict lit = light_dn;
  ENAMEL_INDEPENDENT
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t u = 2 * k;
    const PixelChange d = row.change<kSteady>(u);
    const Pixel raw = row.raw(u), p = at_mid_burst(raw, lights_of<kSteady>(d), turns_of<kSteady>(d));
    moved[k] = row.phase[u] + ahead(raw, p);
    lit[k] = p.mean;
  }
}

void mid_burst_loop(const CodeRow& row, std::size_t count, float* phase_rad, float* light_dn) {
  (row.steady ? mid_burst<true> : mid_burst<false>)(Row(row), count, phase_rad, light_dn);
}

/// As at mid-burst; kAtCode: cosine, sine and phase turned on to the instant of the code frame.
template <bool kSteady, bool kAtCode>
void undo(const Row& in, PixelRange of, const MovedRow& out) {
  const Row row = in;
  float *mean = out.mean, *cosine = out.cosine, *sine = out.sine;
  float *code = out.code, *modulation = out.modulation, *phase = out.phase;
  ENAMEL_INDEPENDENT  // what is written may be the row's own
      for (std::size_t u = of.begin; u < of.end; ++u) {
    const bool inside = row.wraps[u] > kNoSurface;
    const PixelChange d = row.change<kSteady>(u);
    const Lights lights = lights_of<kSteady>(d);
    const Pixel raw = row.raw(u), p = at_mid_burst(raw, lights, turns_of<kSteady>(d));
    const float seen = row.code[u], at_code = (raw.mean + seen) * lights.of_code - p.mean;
    const float on = kAtCode ? d.turned(kCodeTime) : 0;
    const Turn turn = kAtCode ? Turn{cos_poly(on), sin_poly(on)} : Turn{1, 0};
    phase[u] = row.phase[u] + select(inside, ahead(raw, p) + on, 0);
    code[u] = select(inside, at_code, seen);
    mean[u] = select(inside, p.mean + row.black_dn, row.mean[u]);
    cosine[u] = select(inside, p.cosine * turn.cos - p.sine * turn.sin, raw.cosine);
    sine[u] = select(inside, p.sine * turn.cos + p.cosine * turn.sin, raw.sine);
    modulation[u] = select(inside, root(p.cosine * p.cosine + p.sine * p.sine + 1e-6F), row.modulation[u]);
  }
}

void undo_loop(const CodeRow& row, std::size_t width, const MovedRow& out) {
  const auto undo_range = row.steady ? undo<true, false> : undo<false, false>;
  for (PixelRange r = next_surface(row.wraps, kNoSurface, 0, width); r.begin < width;
       r = next_surface(row.wraps, kNoSurface, r.end, width))
    undo_range(Row(row), r, out);
}

void at_code_loop(const CodeRow& row, std::size_t width, const MovedRow& out) {
  (row.steady ? undo<true, true> : undo<false, true>)(Row(row), {0, width}, out);
}

/// How much better than with `squares` the code frame is explained where the order turns its angle: off is what it
/// shows beyond gb cos, gb the light of the fringe there.
[[gnu::always_inline]] inline float doubt_of(float off, float squares, float gb, Turn was, Turn now, float own,
                                             float slopes) {
  const float left = off + gb * (was.cos - now.cos), slope = gb * now.sin;
  const float better = 0.5F * (squares - left * left / (own + slopes * slope * slope));
  return smaller(larger(better, -kMostDoubt), kMostDoubt);
}

void join_range(const CodeRow& in, const NoiseModel& model, const JoinLimits& limits, PixelRange of,
                const JoinedRow& out) {
  const NoiseModel noise = model;  // copies cannot alias what is written
  const Row row(in);
  const float r = 1 + row.wave.inverse_ratio, gate = limits.outlier_sigmas * limits.outlier_sigmas;
  const float largest_gain = limits.largest_gain;
  const Turn step = limits.order_step, back = -step;
  float *phase = out.phase, *sigma = out.sigma, *missed = out.missed, *share_of_noise = out.noise;
  float *one_more = out.doubt.one_more, *one_less = out.doubt.one_less;
  ENAMEL_INDEPENDENT  // `phase` may be the row's own
      for (std::size_t u = of.begin; u < of.end; ++u) {
    const float turned = row.change<false>(u).turned(kCodeTime), was = row.phase[u], gain = row.gain[u];
    const CodeModel k = code_model(row.wraps[u], was, r * turned, row.wave);
    const float gb = gain * row.modulation[u] * k.modulation, off = row.code[u] - gb * k.light;
    const float slope = -gb * r * k.angle.sin;
    // The code frame's own noise, and that of A and B in what it is compared with.
    const float fitted = gain * k.angle.cos;
    const float own =
        noise.variance(row.mean[u] + gb * k.light) + noise.variance(row.mean[u]) * kThird * (1 + 2 * fitted * fitted);
    const float variance = sigma[u] * sigma[u], of_residual = own + slope * slope * variance, inverse = 1 / of_residual;
    const float squares = off * off * inverse;
    const bool placed = row.placed(u), joins = (squares < gate) & placed;  // false for NaN
    missed[u] = select(placed, squares, 0);
    share_of_noise[u] = select(placed, of_residual / (row.modulation[u] * row.modulation[u] + 1e-6F), 0);
    const bool seen = placed & (squares == squares);
    const float slopes = r * r * variance, sound_gb = smaller(gain, largest_gain) * row.modulation[u] * k.modulation;
    const float sound_off = row.code[u] - sound_gb * k.light, sound_squares = sound_off * sound_off * inverse;
    const Turn after = k.angle + step, before = k.angle + back;
    one_more[u] = select(seen, doubt_of(sound_off, sound_squares, sound_gb, k.angle, after, own, slopes), 0);
    one_less[u] = select(seen, doubt_of(sound_off, sound_squares, sound_gb, k.angle, before, own, slopes), 0);
    const float share = select(joins, variance * slope * inverse, 0);
    phase[u] = was + share * select(joins, off, 0);
    sigma[u] = root(variance * (1 - share * slope));
  }
}

/// Rejects what an edge has passed, and forgets the noise of pixels that are rejected.
void reject_torn(float torn, PixelRange of, const JoinedRow& out) {
  const float* __restrict missed = out.missed;
  float* __restrict noise = out.noise;
  PixelReject* __restrict reject = out.reject;
  for (std::size_t u = of.begin; u < of.end; ++u) {
    const auto was = static_cast<unsigned>(reject[u]);
    const bool edge = (missed[u] > torn) & (was == 0);  // kNone
    noise[u] = select(!edge & (was == 0), noise[u], 0);
    reject[u] = static_cast<PixelReject>(edge ? static_cast<unsigned>(PixelReject::kEdge) : was);
  }
}

void join_loop(const CodeRow& row, const NoiseModel& noise, const JoinLimits& limits, std::size_t width,
               const JoinedRow& out) {
  for (std::size_t done = 0; done < width;) {
    const PixelRange r = next_surface(row.wraps, kUnplaced, done, width);
    for (float* v : {out.missed, out.noise, out.doubt.one_more, out.doubt.one_less})
      std::fill(v + done, v + r.begin, 0.0F);
    join_range(row, noise, limits, r, out);
    reject_torn(limits.torn_sigmas * limits.torn_sigmas, r, out);
    done = r.end;
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(add_loop);
HWY_EXPORT(residual_loop);
HWY_EXPORT(mid_burst_loop);
HWY_EXPORT(undo_loop);
HWY_EXPORT(at_code_loop);
HWY_EXPORT(join_loop);

void add_refit_row(const CodeRow& row, const NoiseModel& noise, float max_residual, std::size_t width, float* sums) {
  HWY_DYNAMIC_DISPATCH(add_loop)(row, noise, max_residual, width, sums);
}

void code_residual_row(const CodeRow& row, std::size_t count, const ResidualRow& out) {
  HWY_DYNAMIC_DISPATCH(residual_loop)(row, count, out);
}

void sparse_mid_burst_row(const CodeRow& row, std::size_t count, float* phase_rad, float* light_dn) {
  HWY_DYNAMIC_DISPATCH(mid_burst_loop)(row, count, phase_rad, light_dn);
}

void undo_motion_row(const CodeRow& row, std::size_t width, const MovedRow& out) {
  HWY_DYNAMIC_DISPATCH(undo_loop)(row, width, out);
}

void move_to_code_row(const CodeRow& row, std::size_t width, const MovedRow& out) {
  HWY_DYNAMIC_DISPATCH(at_code_loop)(row, width, out);
}

void join_code_row(const CodeRow& row, const NoiseModel& noise, const JoinLimits& limits, std::size_t width,
                   const JoinedRow& out) {
  HWY_DYNAMIC_DISPATCH(join_loop)(row, noise, limits, width, out);
}

}  // namespace enamel::pipeline
#endif
