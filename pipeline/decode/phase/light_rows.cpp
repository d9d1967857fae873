#include "pipeline/decode/phase/light_rows.hpp"

#include <array>
#include <cstring>
#include <utility>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/phase/light_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

constexpr std::array<LightColumn, 8> kOfFringe = {kCosine, kSine, kAlong, kAcross, kCosine2, kSine2, kLevel, kSaid};
constexpr std::array<LightColumn, 5> kOfRest = {kCosine, kSine, kRest, kGain, kSaid};

constexpr std::size_t kSumLanes = 8;  // layout: pixels side by side
/// A vector type of g++ and clang: left to themselves, they load the factors of each product anew.
using SumLanes [[gnu::vector_size(4 * kSumLanes)]] = float;

template <class T>
[[gnu::always_inline]] inline void load_at(const float* from, T& out) {
  std::memcpy(&out, from, sizeof out);
}

template <class T>
[[gnu::always_inline]] inline void add_at(float* sum, const T& value) {
  T now;
  load_at(sum, now);
  now += value;
  std::memcpy(sum, &now, sizeof now);
}

template <class T, std::size_t kCount>
struct Factors {
  std::array<T, kCount> of;
};

/// Products of column I and those after it.
template <const auto& kColumns, std::size_t I, class T, std::size_t... J>
[[gnu::always_inline]] inline void add_from(const T& weighted, const Factors<T, kColumns.size()>& f, std::size_t width,
                                            float* sums, std::index_sequence<J...>) {
  (add_at(sums + light_sum_of(kColumns[I], kColumns[I + J]) * width, weighted * f.of[I + J]), ...);
}

template <const auto& kColumns, class T, std::size_t... I>
[[gnu::always_inline]] inline void add_all(const float* stretch, std::size_t width, float* sums,
                                           std::index_sequence<I...>) {
  const T none{};
  T weight;
  Factors<T, kColumns.size()> f;
  load_at(stretch + kLightWeight * width, weight);
  (load_at(stretch + kColumns[I] * width, f.of[I]), ...);
  (add_from<kColumns, I, T>(weight * f.of[I], f, width, sums, std::make_index_sequence<kColumns.size() - I>()), ...);
  const T counted = weight > none ? none + 1 : none;
  add_at(sums + kLightCount * width, counted);
}

template <const auto& kColumns>
[[gnu::always_inline]] inline void add_products(const float* stretch, std::size_t width, float* sums) {
  constexpr auto kEach = std::make_index_sequence<kColumns.size()>();
  std::size_t u = 0;
  for (; u + kSumLanes <= width; u += kSumLanes) add_all<kColumns, SumLanes>(stretch + u, width, sums + u, kEach);
  for (; u < width; ++u) add_all<kColumns, float>(stretch + u, width, sums + u, kEach);
}

void fringe_loop(const LightRow& in, LampLight of, std::size_t width, float* stretch, float* sums) {
  const auto to = [&](LightColumn k) { return stretch + k * width; };
  const float* __restrict lights = in.light, * __restrict xs = in.cosine, * __restrict ys = in.sine;
  const float* __restrict weights = in.weight;
  float* __restrict cosine = to(kCosine), * __restrict sine = to(kSine), * __restrict said = to(kSaid);
  float* __restrict cosine2 = to(kCosine2), * __restrict sine2 = to(kSine2), * __restrict weight = to(kLightWeight);
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const bool asked = weights[u] > 0;
    const float light = select(asked, lights[u], 1);
    const float x = select(asked, xs[u], 1), y = select(asked, ys[u], 0);
    const float b = root(x * x + y * y + 1e-6F), c = x / b, s = y / b;
    const float base = lamp_base_dn(of, light) / light;
    cosine[u] = c * base, sine[u] = s * base, cosine2[u] = c * c - s * s, sine2[u] = 2 * c * s;
    said[u] = b / light;
    weight[u] = select(asked, weights[u] * light * light, 0);
  }
  add_products<kOfFringe>(stretch, width, sums);
}

void rest_loop(const LightRow& in, LampLight of, std::size_t width, float* stretch, float* sums) {
  const auto to = [&](LightColumn k) { return stretch + k * width; };
  const float* __restrict lights = in.light, * __restrict by_cosine = in.rest_by_cosine;
  const float* __restrict by_sine = in.rest_by_sine, * __restrict by_gain = in.rest_by_gain;
  const float* __restrict off = in.rest, * __restrict weights = in.rest_weight;
  float* __restrict cosine = to(kCosine), * __restrict sine = to(kSine), * __restrict gain = to(kGain);
  float* __restrict said = to(kSaid), * __restrict weight = to(kLightWeight), * __restrict rest = to(kRest);
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const bool asked = weights[u] > 0;
    const float light = select(asked, lights[u], 1), inverse = 1 / light;
    const float base = lamp_base_dn(of, light) * inverse;
    cosine[u] = select(asked, by_cosine[u] * base, 0), sine[u] = select(asked, by_sine[u] * base, 0);
    rest[u] = base;
    gain[u] = select(asked, by_gain[u] * inverse, 0);
    said[u] = select(asked, off[u] * inverse, 0);
    weight[u] = select(asked, weights[u] * light * light, 0);
  }
  add_products<kOfRest>(stretch, width, sums);
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(fringe_loop);
HWY_EXPORT(rest_loop);

void add_lamp_fringe_row(const LightRow& row, LampLight of, std::size_t width, float* stretch, float* sums) {
  HWY_DYNAMIC_DISPATCH(fringe_loop)(row, of, width, stretch, sums);
}

void add_lamp_rest_row(const LightRow& row, LampLight of, std::size_t width, float* stretch, float* sums) {
  HWY_DYNAMIC_DISPATCH(rest_loop)(row, of, width, stretch, sums);
}

}  // namespace enamel::pipeline
#endif
