#include "pipeline/decode/motion/motion_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/motion/motion_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "pipeline/decode/motion/slope_pairs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void known_loop(const SampleRow& in, std::size_t count, float max_residual, const SampledResiduals& out) {
  const float* __restrict rates = in.rate, * __restrict lights = in.light, * __restrict shares = in.shared;
  const float* __restrict rest = in.residual, * __restrict known_rate = in.known_rate;
  const float* __restrict known_light = in.known_light, * __restrict b = in.modulation, * __restrict open = in.open;
  float* __restrict rate = out.rate, * __restrict light = out.light, * __restrict shared = out.shared;
  float* __restrict residual = out.residual, * __restrict used = out.used;
  ENAMEL_INDEPENDENT
  for (std::size_t k = 0; k < count; ++k) {
    const bool asked = (open[k] > 0) & (std::abs(rest[k]) < max_residual * b[k]);
    const float r = rates[k], l = lights[k];
    rate[k] = select(asked, r, 0);
    light[k] = select(asked, l, 0);
    shared[k] = select(asked, shares[k], 0);
    residual[k] = select(asked, rest[k] + r * known_rate[k] + l * known_light[k], 0);
    used[k] = select(asked, 1, 0);
  }
}

template <class T>
[[gnu::always_inline]] inline void slopes_of(const MotionImages& images, int node_row, int begin, const SlopeRow& out) {
  PairSums<T> s;
  T limit;
  load(out.limit + begin, limit);
  for (int dy = 0; dy <= kReach; ++dy) {
    for (int dx = dy == 0 ? 1 : -kReach; dx <= kReach; ++dx)
      add_pairs(images, {node_row, 0, 0, begin}, dx, dy, limit, s);
  }
  const T det = s.uu * s.vv - s.uv * s.uv;
  const T q_u = s.vv * s.q_u - s.uv * s.q_v, q_v = s.uu * s.q_v - s.uv * s.q_u;
  const T a_u = s.vv * s.a_u - s.uv * s.a_v, a_v = s.uu * s.a_v - s.uv * s.a_u;
  std::memcpy(out.det + begin, &det, sizeof det);
  std::memcpy(out.q_u + begin, &q_u, sizeof q_u);
  std::memcpy(out.q_v + begin, &q_v, sizeof q_v);
  std::memcpy(out.a_u + begin, &a_u, sizeof a_u);
  std::memcpy(out.a_v + begin, &a_v, sizeof a_v);
}

void slope_loop(const MotionImages& images, int node_row, int begin, int end, const SlopeRow& out) {
  constexpr auto kLanes = static_cast<int>(kNodeLanes);
  if (end - begin < kLanes) {
    for (int n = begin; n < end; ++n) slopes_of<float>(images, node_row, n, out);
    return;
  }
  for (int n = begin; n < end; n += kLanes)  // the last lanes repeat some nodes
    slopes_of<Lanes>(images, node_row, std::min(n, end - kLanes), out);
}

/// Sums over the pixels of kNodeLanes nodes: products of the columns of eps (r), dA/A (l), rho (h) and the residual.
struct NodeSums {
  Lanes rr{}, rl{}, ll{}, rh{}, lh{}, hh{}, ry{}, ly{}, hy{}, squares{}, pixels{};
};

[[gnu::always_inline]] inline void sum_nodes(const MotionSamples& s, std::size_t n, const Lanes& eps,
                                             const Lanes& change, const Lanes& counts, float rho, float limit,
                                             NodeSums& o) {
  const Lanes none{}, most = none + limit;
  for (std::size_t p = 0; p < kNodePixels; ++p) {
    const std::size_t at = MotionSamples::place(p, n);
    Lanes rate, per_rate, light, shared, y, used;
    load(&s.rate[at], rate), load(&s.rate_per_rate[at], per_rate), load(&s.light[at], light);
    load(&s.shared[at], shared), load(&s.residual[at], y), load(&s.used[at], used);
    const Lanes x = rate + eps * per_rate, rest = y - x * eps - light * change - shared * rho;
    const auto counted = (rest <= most) & (-rest <= most) & (used * counts > none);
    const Lanes r = counted ? x : none, l = counted ? light : none, h = counted ? shared : none;
    const Lanes left_over = counted ? rest : none;
    o.rr += r * r, o.rl += r * l, o.ll += l * l;
    o.rh += r * h, o.lh += l * h, o.hh += h * h;
    o.ry += r * y, o.ly += l * y, o.hy += h * y;
    o.squares += left_over * left_over;
    o.pixels += counted ? none + 1 : none;
  }
}

/// The six unknowns and two lanes of 0.
using Six [[gnu::vector_size(64)]] = double;
static_assert(kColumnLanes == 8);

/// Normal equations while they are added up.
struct SixSums {
  std::array<Six, 6> left{};
  Six shared{}, right{};  ///< products with the column of what all pixels share, and with the residual
};

[[gnu::always_inline]] inline void load_six(const float* from, Six& out) {
  Lanes narrow;
  static_assert(kNodeLanes == kColumnLanes);
  std::memcpy(&narrow, from, sizeof narrow);
  out = __builtin_convertvector(narrow, Six);
}

/// One node's part: its pixels' columns are r (row of eps) + l (row of dA/A), and h.
[[gnu::always_inline]] inline void add_node(const NodeSums& s, std::size_t j, const Six& rate, const Six& light,
                                            SixSums& sums, MotionEquations& out) {
  const auto rr = static_cast<double>(s.rr[j]), rl = static_cast<double>(s.rl[j]), ll = static_cast<double>(s.ll[j]);
  const auto rh = static_cast<double>(s.rh[j]), lh = static_cast<double>(s.lh[j]);
  const auto ry = static_cast<double>(s.ry[j]), ly = static_cast<double>(s.ly[j]);
  const Six a = rr * rate + rl * light, b = rl * rate + ll * light;
  sums.left[0] += a[0] * rate + b[0] * light;
  sums.left[1] += a[1] * rate + b[1] * light;
  sums.left[2] += a[2] * rate + b[2] * light;
  sums.left[3] += a[3] * rate + b[3] * light;
  sums.left[4] += a[4] * rate + b[4] * light;
  sums.left[5] += a[5] * rate + b[5] * light;
  sums.shared += rh * rate + lh * light;
  sums.right += ry * rate + ly * light;
  out.left[6][6] += static_cast<double>(s.hh[j]);
  out.right[6] += static_cast<double>(s.hy[j]);
  out.squares += static_cast<double>(s.squares[j]);
  out.pixels += static_cast<double>(s.pixels[j]);
}

void samples_loop(const MotionSamples& s, const MotionColumns& c, const std::array<double, 7>& theta, double limit,
                  MotionEquations& out) {
  MotionEquations e;
  SixSums six;
  for (std::size_t n = 0; n < s.nodes; n += kNodeLanes) {
    Lanes eps{}, change{}, counts{};
    for (std::size_t k = 0; k < 6; ++k) {
      const auto t = static_cast<float>(theta[k]);
      Lanes rate, light;
      load(&c.rate[k * s.nodes + n], rate), load(&c.light[k * s.nodes + n], light);
      eps += rate * t;
      change += light * t;
    }
    load(&c.counts[n], counts);
    NodeSums sums;
    sum_nodes(s, n, eps, change, counts, static_cast<float>(theta[6]), static_cast<float>(limit), sums);
    for (std::size_t j = 0; j < kNodeLanes; ++j) {
      if (!(sums.pixels[j] > 0)) continue;
      Six rate, light;
      const float* columns = &c.by_node[2 * kColumnLanes * (n + j)];
      load_six(columns, rate), load_six(columns + kColumnLanes, light);
      add_node(sums, j, rate, light, six, e);
    }
  }
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t i = 0; i < 6; ++i) e.left[k][i] = six.left[k][i];
    e.left[k][6] = six.shared[k];
    e.right[k] = six.right[k];
  }
  out = e;
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(known_loop);
HWY_EXPORT(slope_loop);
HWY_EXPORT(samples_loop);

void known_row(const SampleRow& row, std::size_t count, float max_residual, const SampledResiduals& out) {
  HWY_DYNAMIC_DISPATCH(known_loop)(row, count, max_residual, out);
}

void slope_row(const MotionImages& images, int node_row, int begin, int end, const SlopeRow& out) {
  HWY_DYNAMIC_DISPATCH(slope_loop)(images, node_row, begin, end, out);
}

void add_samples(const MotionSamples& samples, const MotionColumns& columns, const std::array<double, 7>& theta,
                 double limit, MotionEquations& out) {
  HWY_DYNAMIC_DISPATCH(samples_loop)(samples, columns, theta, limit, out);
}

}  // namespace enamel::pipeline
#endif
