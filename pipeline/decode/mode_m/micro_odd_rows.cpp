#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/decode/mode_m/micro_pixel.hpp"
#include "pipeline/decode/mode_m/micro_refit_rows.hpp"
#include "pipeline/decode/phase/polar_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/mode_m/micro_odd_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "pipeline/decode/mode_m/micro_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// Columns of the odd frame's unknowns, the residual and its weight, a stretch at a time; their products follow in
/// loops of their own, which the registers hold.
struct OddStretch {
  std::array<std::array<float, kPolarStretch>, kOddColumns + 1> x;  ///< the last: the residual
  std::array<float, kPolarStretch> weight, asked, used;
};

template <bool kSteady>
void odd_columns(const CodeRow& in, const NoiseModel& model, float limit, std::size_t from, std::size_t count,
                 OddStretch& out) {
  const NoiseModel noise = model;
  const Row row(in);
  const auto to = [&](std::size_t k) { return out.x[k].data(); };
  float* __restrict alone = to(0), * __restrict skew = to(1), * __restrict alone_light = to(2);
  float* __restrict skew_light = to(3), * __restrict motion = to(4), * __restrict light = to(5);
  float* __restrict gain = to(6), * __restrict second = to(7), * __restrict third = to(8), * __restrict rest = to(9);
  float* __restrict weight = out.weight.data(), * __restrict asked = out.asked.data(), * __restrict used = out.used.data();
  ENAMEL_INDEPENDENT
  for (std::size_t j = 0; j < count; ++j) {
    const std::size_t u = from + j;
    const Residual k = row.residual<kSteady>(u);
    const bool placed = row.placed(u), known = (k.rest == k.rest) & placed;
    const bool counts = (std::abs(k.rest) < limit * k.modulation) & known;
    alone[j] = k.by_alone, skew[j] = k.by_skew;
    alone_light[j] = k.by_alone_light, skew_light[j] = k.by_skew_light;
    motion[j] = k.by_motion, light[j] = k.by_light, gain[j] = k.by_gain;
    second[j] = k.by_second, third[j] = k.by_third;
    rest[j] = select(counts, -k.rest, 0);
    weight[j] = select(counts, 1 / (kResidualVariance * noise.variance(row.mean[u])), 0);
    asked[j] = select(known, 1, 0);
    used[j] = select(counts, 1, 0);
  }
}

void add_product(const float* a, const float* b, const float* weights, std::size_t count, float* sums) {
  const float* __restrict x = a, * __restrict y = b, * __restrict w = weights;
  float* __restrict sum = sums;
  ENAMEL_INDEPENDENT  // x and y may be one
      for (std::size_t j = 0; j < count; ++j) sum[j] += w[j] * x[j] * y[j];
}

void add_to(const float* values, std::size_t count, float* sums) {
  const float* __restrict x = values;
  float* __restrict sum = sums;
  for (std::size_t j = 0; j < count; ++j) sum[j] += x[j];
}

void odd_loop(const CodeRow& row, const NoiseModel& noise, float limit, std::size_t width, float* sums) {
  OddStretch stretch;
  for (std::size_t from = 0; from < width; from += kPolarStretch) {
    const std::size_t count = std::min(kPolarStretch, width - from);
    if (!has_surface(row.wraps, kUnplaced, {from, from + count})) continue;
    (row.steady ? odd_columns<true> : odd_columns<false>)(row, noise, limit, from, count, stretch);
    float* to = sums + from;
    for (std::size_t i = 0; i < kOddColumns; ++i) {
      for (std::size_t j = i; j <= kOddColumns; ++j, to += width)
        add_product(stretch.x[i].data(), stretch.x[j].data(), stretch.weight.data(), count, to);
    }
    add_product(stretch.x[kOddColumns].data(), stretch.x[kOddColumns].data(), stretch.weight.data(), count, to);
    add_to(stretch.used.data(), count, to + width);
    add_to(stretch.asked.data(), count, to + 2 * width);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(odd_loop);

void add_micro_odd_row(const CodeRow& row, const NoiseModel& noise, float max_residual, std::size_t width,
                       float* sums) {
  HWY_DYNAMIC_DISPATCH(odd_loop)(row, noise, max_residual, width, sums);
}

}  // namespace enamel::pipeline
#endif
