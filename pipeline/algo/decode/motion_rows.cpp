#include "pipeline/algo/decode/motion_rows.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/decode/motion_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

void closure_loop(const PhaseMaps& m, const float* weight, float black_dn, float max_residual, std::size_t at,
                  std::size_t count, const ClosureRow& out) {
  static_assert(kPixelStep == 2);
  const float* __restrict cosine = &m.cosine_dn[at], * __restrict sine = &m.sine_dn[at];
  const float* __restrict modulation = &m.modulation_dn[at], * __restrict mean = &m.mean_dn[at];
  const float* __restrict closure = &m.code_dn[at], * __restrict weights = weight;
  const PixelReject* __restrict reject = &m.reject[at];
  float* __restrict rate = out.rate, * __restrict per_rate = out.rate_per_rate, * __restrict light = out.light;
  float* __restrict shared = out.shared, * __restrict residual = out.residual, * __restrict used = out.used;
  for (std::size_t k = 0; k < count; ++k) used[k] = select(reject[2 * k] == PixelReject::kNone, 1, 0);
  ENAMEL_INDEPENDENT
  for (std::size_t k = 0; k < count; ++k) {
    const float c = cosine[2 * k], s = sine[2 * k], b = modulation[2 * k], r = closure[2 * k], w = weights[2 * k];
    const float sign = std::abs(w), off = std::abs(r);
    const bool asked = (used[k] > 0) & (sign > 0.999F) & (off < max_residual * b), plus = w > 0;
    const float own = mean[2 * k] - black_dn;
    rate[k] = select(asked, select(plus, 2 * (s - c), -2 * c), 0);
    per_rate[k] = select(asked, select(plus, 2 * (s - c), 2 * s), 0);
    light[k] = select(asked, select(plus, -2 * (own + c + s), 2 * (own - s)), 0);
    shared[k] = select(asked & plus, 4 * (c - s) * (c + s) / (b + 1e-6F), 0);
    residual[k] = select(asked, r, 0);
    used[k] = select(asked, 1, 0);
  }
}

constexpr std::size_t kSlopeSums = 7;  ///< uu uv vv of the pairs' distances, u v of 1/z, u v of A
using Lanes = std::array<float, kNodeLanes>;
using SlopeSums = std::array<Lanes, kSlopeSums>;

/// The pairs at +-(dx, dy) of kCount nodes.
template <std::size_t kCount>
[[gnu::always_inline]] inline void add_pairs(const MotionImages& images, int node_row, int dx, int dy, int begin,
                                             const float* limit, SlopeSums& sums) {
  const float* __restrict q_plus = images.inverse_depth.around(node_row, dx, dy) + begin;
  const float* __restrict q_minus = images.inverse_depth.around(node_row, -dx, -dy) + begin;
  const float* __restrict a_plus = images.light.around(node_row, dx, dy) + begin;
  const float* __restrict a_minus = images.light.around(node_row, -dx, -dy) + begin;
  const auto x = static_cast<float>(4 * dx), y = static_cast<float>(4 * dy);  // pixels of the full image
  const float reach = std::abs(x) + std::abs(y);
  ENAMEL_INDEPENDENT
  for (std::size_t j = 0; j < kCount; ++j) {
    const float step = q_plus[j] - q_minus[j];
    const bool same = std::abs(step) < limit[j] * reach;  // false for NaN
    const float d = select(same, step, 0), a = select(same, a_plus[j] - a_minus[j], 0);
    sums[0][j] += select(same, x * x, 0);
    sums[1][j] += select(same, x * y, 0);
    sums[2][j] += select(same, y * y, 0);
    sums[3][j] += x * d;
    sums[4][j] += y * d;
    sums[5][j] += x * a;
    sums[6][j] += y * a;
  }
}

template <std::size_t kCount>
[[gnu::always_inline]] inline void slopes_of(const MotionImages& images, int node_row, int begin, const SlopeRow& out) {
  SlopeSums s{};
  for (int dy = 0; dy <= kReach; ++dy) {
    for (int dx = dy == 0 ? 1 : -kReach; dx <= kReach; ++dx)
      add_pairs<kCount>(images, node_row, dx, dy, begin, out.limit + begin, s);
  }
  for (std::size_t j = 0; j < kCount; ++j) {
    const std::size_t n = static_cast<std::size_t>(begin) + j;
    out.det[n] = s[0][j] * s[2][j] - s[1][j] * s[1][j];
    out.q_u[n] = s[2][j] * s[3][j] - s[1][j] * s[4][j];
    out.q_v[n] = s[0][j] * s[4][j] - s[1][j] * s[3][j];
    out.a_u[n] = s[2][j] * s[5][j] - s[1][j] * s[6][j];
    out.a_v[n] = s[0][j] * s[6][j] - s[1][j] * s[5][j];
  }
}

void slope_loop(const MotionImages& images, int node_row, int begin, int end, const SlopeRow& out) {
  constexpr auto kLanes = static_cast<int>(kNodeLanes);
  if (end - begin < kLanes) {
    for (int n = begin; n < end; ++n) slopes_of<1>(images, node_row, n, out);
    return;
  }
  for (int n = begin; n < end; n += kLanes)  // the last lanes repeat some nodes
    slopes_of<kNodeLanes>(images, node_row, std::min(n, end - kLanes), out);
}

/// Sums over the pixels of kNodeLanes nodes: products of the columns of eps (r), dA/A (l), rho (h) and the residual.
struct NodeSums {
  Lanes rr{}, rl{}, ll{}, rh{}, lh{}, hh{}, ry{}, ly{}, hy{}, squares{}, pixels{};
};

[[gnu::always_inline]] inline void sum_nodes(const MotionSamples& s, std::size_t n, const Lanes& eps,
                                             const Lanes& change, const Lanes& counts, float rho, float limit,
                                             NodeSums& o) {
  for (std::size_t p = 0; p < kNodePixels; ++p) {
    const std::size_t at = p * s.nodes + n;
    const float* __restrict rate = &s.rate[at], * __restrict per_rate = &s.rate_per_rate[at];
    const float* __restrict light = &s.light[at], * __restrict shared = &s.shared[at];
    const float* __restrict residual = &s.residual[at], * __restrict used = &s.used[at];
    ENAMEL_INDEPENDENT
    for (std::size_t j = 0; j < kNodeLanes; ++j) {
      const float x = rate[j] + eps[j] * per_rate[j];
      const float rest = residual[j] - x * eps[j] - light[j] * change[j] - shared[j] * rho;
      const float asked = used[j] * counts[j];
      const bool counted = (std::abs(rest) <= limit) & (asked > 0);
      const float r = select(counted, x, 0), l = select(counted, light[j], 0), h = select(counted, shared[j], 0);
      const float y = residual[j], left_over = select(counted, rest, 0);
      o.rr[j] += r * r, o.rl[j] += r * l, o.ll[j] += l * l;
      o.rh[j] += r * h, o.lh[j] += l * h, o.hh[j] += h * h;
      o.ry[j] += r * y, o.ly[j] += l * y, o.hy[j] += h * y;
      o.squares[j] += left_over * left_over;
      o.pixels[j] += select(counted, 1, 0);
    }
  }
}

/// One node's part in the normal equations: its pixels' columns are r (row of eps) + l (row of dA/A), and h.
[[gnu::always_inline]] inline void add_node(const NodeSums& s, std::size_t j, const std::array<double, 8>& rate,
                                            const std::array<double, 8>& light, MotionEquations& out) {
  const auto rr = static_cast<double>(s.rr[j]), rl = static_cast<double>(s.rl[j]), ll = static_cast<double>(s.ll[j]);
  const auto rh = static_cast<double>(s.rh[j]), lh = static_cast<double>(s.lh[j]);
  const auto ry = static_cast<double>(s.ry[j]), ly = static_cast<double>(s.ly[j]);
  for (std::size_t k = 0; k < 6; ++k) {
    const double a = rr * rate[k] + rl * light[k], b = rl * rate[k] + ll * light[k];
    for (std::size_t i = k / 4 * 4; i < 8; ++i) out.left[k][i] += a * rate[i] + b * light[i];  // by whole vectors
    out.left[k][6] += rh * rate[k] + lh * light[k];
  }
  for (std::size_t i = 0; i < 8; ++i) out.right[i] += ry * rate[i] + ly * light[i];
  out.left[6][6] += static_cast<double>(s.hh[j]);
  out.right[6] += static_cast<double>(s.hy[j]);
  out.squares += static_cast<double>(s.squares[j]);
  out.pixels += static_cast<double>(s.pixels[j]);
}

void samples_loop(const MotionSamples& s, const MotionColumns& c, const std::array<double, 7>& theta, double limit,
                  MotionEquations& out) {
  MotionEquations e = out;
  for (std::size_t n = 0; n < s.nodes; n += kNodeLanes) {
    Lanes eps{}, change{}, counts{};
    for (std::size_t k = 0; k < 6; ++k) {
      const auto t = static_cast<float>(theta[k]);
      for (std::size_t j = 0; j < kNodeLanes; ++j) {
        eps[j] += c.rate[k * s.nodes + n + j] * t;
        change[j] += c.light[k * s.nodes + n + j] * t;
      }
    }
    for (std::size_t j = 0; j < kNodeLanes; ++j) counts[j] = c.counts[n + j];
    NodeSums sums;
    sum_nodes(s, n, eps, change, counts, static_cast<float>(theta[6]), static_cast<float>(limit), sums);
    for (std::size_t j = 0; j < kNodeLanes; ++j) {
      if (!(sums.pixels[j] > 0)) continue;
      std::array<double, 8> rate{}, light{};
      for (std::size_t k = 0; k < 6; ++k) {
        rate[k] = static_cast<double>(c.rate[k * s.nodes + n + j]);
        light[k] = static_cast<double>(c.light[k * s.nodes + n + j]);
      }
      add_node(sums, j, rate, light, e);
    }
  }
  out = e;
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(closure_loop);
HWY_EXPORT(slope_loop);
HWY_EXPORT(samples_loop);

void closure_row(const PhaseMaps& maps, const float* weight, float black_dn, float max_residual, std::size_t at,
                 std::size_t count, const ClosureRow& out) {
  HWY_DYNAMIC_DISPATCH(closure_loop)(maps, weight, black_dn, max_residual, at, count, out);
}

void slope_row(const MotionImages& images, int node_row, int begin, int end, const SlopeRow& out) {
  HWY_DYNAMIC_DISPATCH(slope_loop)(images, node_row, begin, end, out);
}

void add_samples(const MotionSamples& samples, const MotionColumns& columns, const std::array<double, 7>& theta,
                 double limit, MotionEquations& out) {
  HWY_DYNAMIC_DISPATCH(samples_loop)(samples, columns, theta, limit, out);
}

}  // namespace enamel::algo
#endif
