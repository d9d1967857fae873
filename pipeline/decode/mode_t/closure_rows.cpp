#include "pipeline/decode/mode_t/closure_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pipeline/decode/mode_t/frame_solve.hpp"
#include "pipeline/decode/phase/polar_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_t/closure_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void add_loop(const PhaseMaps& m, const PolarityMaps& p, const NoiseModel& model, std::size_t at, std::size_t width,
              float limit, float* sums) {
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const float* __restrict mean = &m.mean_dn[at];
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
    s5[u] += x1 * x1 * noise.variance(mean[u]);
  }
}

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// kSteady: light stays as it is.
template <bool kSteady>
[[gnu::always_inline]] inline FourFrames frames_of(const FourStepPixel& p, float residual, float weight,
                                                   const PixelChange& d) {
  const float b = select(weight < 0, -1, 1), r = select(residual == residual, residual, 0);
  const float three = p.sine + 0.5F * std::abs(weight) * r;  // S of three frames; less the residual that of frame 3
  const FourFrames x{p.mean + p.cosine, p.mean - three, p.mean - p.cosine, p.mean + b * (three - r)};
  if constexpr (kSteady) return x;
  const float l0 = d.light(-1.5F), l1 = d.light(-0.5F), l2 = d.light(0.5F), l3 = d.light(1.5F);
  const float early = l0 * l1, late = l2 * l3, inverse = 1 / (early * late);  // one division for four
  const float of_early = inverse * late, of_late = inverse * early;
  return {x.x0 * (of_early * l1), x.x1 * (of_early * l0), x.x2 * (of_late * l3), x.x3 * (of_late * l2)};
}

/// A, C and S at mid-burst, exactly, by the equations of the frames used (frame_solve.hpp), each at its own time.
/// Frames 1 and 3 enter as one, (1 - q)(A - x1) + q b (x3 - A) with q = w/2, so that noise counts as in polarity.hpp.
[[gnu::always_inline]] inline FourStepPixel solve(const FourFrames& x, float weight, const Turns& t) {
  const float q = 0.5F * std::abs(weight), b = select(weight < 0, -1, 1), of_mean = 0.5F * (1 - q - q * b);
  const float even_c = t.a0.cos + t.a2.cos, even_s = -t.a0.sin - t.a2.sin, even = x.x0 - x.x2;
  const float odd_c = (1 - q) * t.a1.sin + q * t.a3.sin + of_mean * (t.a0.cos - t.a2.cos);
  const float odd_s = (1 - q) * t.a1.cos + q * t.a3.cos - of_mean * (t.a0.sin - t.a2.sin);
  const float odd = of_mean * (x.x0 + x.x2) - (1 - q) * x.x1 + q * b * x.x3;
  const float inverse = 1 / (even_c * odd_s - even_s * odd_c);  // 1/2 at rest, positive for any motion below 0.5 rad
  const float c = (even * odd_s - even_s * odd) * inverse, s = (even_c * odd - even * odd_c) * inverse;
  return {0.5F * (x.x0 + x.x2 - c * (t.a0.cos - t.a2.cos) + s * (t.a0.sin - t.a2.sin)), c, s};
}

/// How far the phase at mid-burst is from that measured, as a vector: its own loop is short enough for its angle to be
/// found for several pixels at once (polar_rows.hpp).
struct Ahead {
  std::array<float, kPolarStretch> cosine, sine;
};

/// What else a row's pixels are asked for.
enum class Beside { kNothing, kLight, kRest };

/// beside: light, or what frame 1 is off the solution by, which is half the closure residual.
template <bool kSteady, Beside kBeside>
[[gnu::always_inline]] inline void mid_burst(const PixelRow& in, std::size_t from, std::size_t count, Ahead& ahead,
                                             float* beside) {
  const float* __restrict c = in.cosine + from, * __restrict s = in.sine + from, * __restrict r = in.code + from;
  const float* __restrict mean = in.mean + from, * __restrict w = in.errors.weight + from;
  const float* __restrict rate = in.errors.rate + from, * __restrict rho = in.errors.harmonic + from;
  const float* __restrict growth = in.errors.light + from, * __restrict rate_change = in.errors.rate_change + from;
  const float* __restrict growth_change = in.errors.light_change + from;
  const float black_dn = in.errors.black_dn;
  float* __restrict x = ahead.cosine.data(), * __restrict y = ahead.sine.data();
  float* __restrict other = kBeside != Beside::kNothing ? beside + from : nullptr;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < count; ++u) {
    const PixelChange d =
        kSteady ? PixelChange{rate[u], 0, 0, 0} : PixelChange{rate[u], rate_change[u], growth[u], growth_change[u]};
    const Turns turns = turns_of<kSteady>(d);
    const FourFrames frames = frames_of<kSteady>({mean[u] - black_dn, c[u], s[u]}, r[u], w[u], d);
    const FourStepPixel p = solve(frames, w[u], turns);
    const FourFrames harmonic = harmonic_of(p, turns);
    const FourStepPixel h = solve(harmonic, w[u], turns);
    const float cosine = p.cosine - rho[u] * h.cosine, sine = p.sine - rho[u] * h.sine, lit = p.mean - rho[u] * h.mean;
    x[u] = cosine * c[u] + sine * s[u];
    y[u] = sine * c[u] - cosine * s[u];
    if constexpr (kBeside == Beside::kLight) other[u] = lit;
    if constexpr (kBeside == Beside::kRest)
      other[u] = frames.x1 - rho[u] * harmonic.x1 - lit + sine * turns.a1.cos + cosine * turns.a1.sin;
  }
}

void add_angle(const Ahead& ahead, const float* measured, std::size_t count, float* phase) {
  const float* __restrict x = ahead.cosine.data(), * __restrict y = ahead.sine.data();
  ENAMEL_INDEPENDENT  // `phase` may be `measured`
      for (std::size_t u = 0; u < count; ++u) phase[u] = measured[u] + atan2_poly(y[u], x[u]);
}

template <bool kSteady, Beside kBeside>
void mid_burst_stretches(const PixelRow& in, std::size_t count, float* phase, float* beside) {
  Ahead ahead;
  for (std::size_t from = 0; from < count; from += kPolarStretch) {
    const std::size_t n = std::min(kPolarStretch, count - from);
    mid_burst<kSteady, kBeside>(in, from, n, ahead, beside);
    add_angle(ahead, in.phase + from, n, phase + from);
  }
}

void mid_burst_loop(const PixelRow& in, std::size_t count, float* phase, float* light) {
  if (light != nullptr) {
    if (in.errors.steady) return mid_burst_stretches<true, Beside::kLight>(in, count, phase, light);
    return mid_burst_stretches<false, Beside::kLight>(in, count, phase, light);
  }
  if (in.errors.steady) return mid_burst_stretches<true, Beside::kNothing>(in, count, phase, nullptr);
  mid_burst_stretches<false, Beside::kNothing>(in, count, phase, nullptr);
}

void closed_loop(const PixelRow& in, const float* modulation, const PixelReject* reject, const NoiseModel& model,
                 std::size_t count, const ClosedRow& out) {
  mid_burst_stretches<false, Beside::kRest>(in, count, out.phase_rad, out.squares);
  const NoiseModel noise = model;  // a copy cannot alias what is written
  const float* __restrict mean = in.mean, * __restrict s = in.sine, * __restrict w = in.errors.weight;
  const float* __restrict b = modulation;
  float* __restrict squares = out.squares, * __restrict share = out.noise;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < count; ++u) {
    // Of four frames: their variance goes with their light, whose mean is A where b = +1, else A - S/2.
    const float variance = 4 * noise.variance(mean[u] - select(w[u] < 0, 0.5F * s[u], 0));
    const bool used = (std::abs(w[u]) > 0.999F) & (reject[u] == PixelReject::kNone);
    squares[u] = 4 * squares[u] * squares[u] / variance;
    share[u] = select(used, variance / (b[u] * b[u] + 1e-6F), 0);
  }
}

void thin_loop(const float* every, std::size_t count, float* second) {
  const float* __restrict in = every;
  float* __restrict out = second;
  for (std::size_t k = 0; k < count; ++k) out[k] = in[kSparseStep * k];
}

void left_loop(const PixelRow& in, std::size_t count, const LeftRow& row) {
  const float* __restrict c = in.cosine, * __restrict s = in.sine, * __restrict r = in.code;
  const float* __restrict mean = in.mean, * __restrict w = in.errors.weight, * __restrict rate = in.errors.rate;
  const float* __restrict growth = in.errors.light;
  const float* __restrict rate_change = in.errors.rate_change, * __restrict growth_change = in.errors.light_change;
  const float black_dn = in.errors.black_dn;
  float* __restrict left = row.residual, * __restrict by_rate = row.by_rate;
  float* __restrict by_light = row.by_light, * __restrict by_harmonic = row.by_harmonic;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < count; ++u) {
    const PixelChange d{rate[u], rate_change[u], growth[u], growth_change[u]};
    const Turns turns = turns_of<false>(d);
    const FourFrames x = frames_of<false>({mean[u] - black_dn, c[u], s[u]}, r[u], w[u], d);
    const FourStepPixel p = solve(x, w[u], turns);
    const float b = select(w[u] < 0, -1, 1);
    const auto unexplained = [&](const FourFrames& f) {
      const FourStepPixel three = solve_first_three(f, turns);
      return d.light(1.5F) * (b * (three.mean - f.x3) + three.sine * turns.a3.cos + three.cosine * turns.a3.sin);
    };
    const bool plus = w[u] > 0;
    left[u] = select((std::abs(w[u]) > 0.999F) & (r[u] == r[u]), unexplained(x), kNone);
    by_rate[u] = 2 * (select(plus, p.sine, 0) - p.cosine);
    by_light[u] = select(plus, -2 * (p.mean + p.cosine + p.sine), 2 * (p.mean - p.sine));
    by_harmonic[u] = unexplained(harmonic_of(p, turns));
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(add_loop);
HWY_EXPORT(mid_burst_loop);
HWY_EXPORT(closed_loop);
HWY_EXPORT(thin_loop);
HWY_EXPORT(left_loop);

PixelRow pixel_row(const PhaseMaps& m, const RowErrors& e, std::size_t at) {
  return {&m.cosine_dn[at], &m.sine_dn[at], &m.code_dn[at], &m.mean_dn[at], &m.phase_rad[at], e};
}

void SparsePixels::take(const PhaseMaps& maps, const PolarityMaps& polarity) {
  const int width = maps.phase_rad.width(), height = maps.phase_rad.height();
  columns_ = (static_cast<std::size_t>(width) + kSparseStep - 1) / kSparseStep;
  const std::size_t rows = (static_cast<std::size_t>(height) + kSparseStep - 1) / kSparseStep;
  const auto take = [&](const Map<float>& from, StaggeredVector<float>& to) {
    to.resize(columns_ * rows);
    for (std::size_t y = 0; y < rows; ++y)
      HWY_DYNAMIC_DISPATCH(thin_loop)(&from(0, static_cast<int>(y * kSparseStep)), columns_, &to[y * columns_]);
  };
  take(maps.cosine_dn, cosine_), take(maps.sine_dn, sine_), take(maps.code_dn, code_);
  take(maps.mean_dn, mean_), take(maps.phase_rad, phase_), take(polarity.weight, weight_);
}

PixelRow SparsePixels::row(ErrorRows& errors, int v) const {
  const std::size_t i = static_cast<std::size_t>(v) / kSparseStep * columns_;
  return {&cosine_[i], &sine_[i], &code_[i], &mean_[i], &phase_[i], errors.with(&weight_[i], v)};
}

RowErrors GatheredErrors::of(const RowErrors& all, const float* weight, const GatheredRuns& runs) {
  constexpr std::size_t kRows = 5;  // layout: gathered ones
  RowErrors out = all;
  if (values_.size() < kRows * runs.pixels()) values_ = RowMemory(kRows * runs.pixels());
  float* next = values_.data();
  const auto take = [&](const float*& row) {
    gather_row(row, runs, next);
    row = next;
    next += runs.pixels();
  };
  take(out.rate), take(out.harmonic), take(out.light), take(out.rate_change), take(out.light_change);
  out.weight = weight;
  return out;
}

void add_closure_row(const PhaseMaps& m, const PolarityMaps& p, const NoiseModel& noise, std::size_t at,
                     std::size_t width, float limit, float* sums) {
  HWY_DYNAMIC_DISPATCH(add_loop)(m, p, noise, at, width, limit, sums);
}

void mid_burst_row(const PixelRow& row, std::size_t count, float* phase_rad, float* light_dn) {
  HWY_DYNAMIC_DISPATCH(mid_burst_loop)(row, count, phase_rad, light_dn);
}

void closed_row(const PixelRow& row, const float* modulation, const PixelReject* reject, const NoiseModel& noise,
                std::size_t count, const ClosedRow& out) {
  HWY_DYNAMIC_DISPATCH(closed_loop)(row, modulation, reject, noise, count, out);
}

void left_row(const PixelRow& row, std::size_t count, const LeftRow& out) {
  HWY_DYNAMIC_DISPATCH(left_loop)(row, count, out);
}

}  // namespace enamel::pipeline
#endif
