// Slopes of 1/z and of light from pairs of pixels opposite to each other about a node, for the loops that Highway
// compiles per instruction set: included by each of them after <hwy/highway.h>, once per target, hence no pragma once.
// Private to pipeline/decode.
#if defined(ENAMEL_SLOPE_PAIRS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ENAMEL_SLOPE_PAIRS_INL_H
#undef ENAMEL_SLOPE_PAIRS_INL_H
#else
#define ENAMEL_SLOPE_PAIRS_INL_H
#endif

#include <cmath>
#include <cstring>

#include "pipeline/decode/motion/motion_images.hpp"
#include "pipeline/decode/motion/motion_samples.hpp"

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// A vector type of g++ and clang: left to themselves, they unroll loops over eight lanes and then work lane by lane.
using Lanes [[gnu::vector_size(4 * kNodeLanes)]] = float;

template <class T>
[[gnu::always_inline]] inline void load(const float* from, T& out) {
  std::memcpy(&out, from, sizeof out);
}

/// uu uv vv of the pairs' distances, u v of 1/z, u v of A.
template <class T>
struct PairSums {
  T uu{}, uv{}, vv{}, q_u{}, q_v{}, a_u{}, a_v{};
};

/// Nodes `begin` and on of a row of the grid; x, y: off their middles, in pixels of the images.
struct NodePlace {
  int node_row, x, y, begin;
};

/// The pairs at +-(dx, dy) of as many nodes as T has lanes.
template <class T>
[[gnu::always_inline]] inline void add_pairs(const MotionImages& images, const NodePlace& at, int dx, int dy,
                                             const T& limit, PairSums<T>& sums) {
  T q_plus, q_minus, a_plus, a_minus;
  load(images.inverse_depth.around(at.node_row, at.x + dx, at.y + dy) + at.begin, q_plus);
  load(images.inverse_depth.around(at.node_row, at.x - dx, at.y - dy) + at.begin, q_minus);
  load(images.light.around(at.node_row, at.x + dx, at.y + dy) + at.begin, a_plus);
  load(images.light.around(at.node_row, at.x - dx, at.y - dy) + at.begin, a_minus);
  const auto x = static_cast<float>(4 * dx), y = static_cast<float>(4 * dy);  // pixels of the full image
  const T none{}, most = limit * (std::abs(x) + std::abs(y)), step = q_plus - q_minus, change = a_plus - a_minus;
  const auto same = (step < most) & (-step < most);  // false for NaN
  const T d = same ? step : none, a = same ? change : none;
  sums.uu += same ? none + x * x : none;
  sums.uv += same ? none + x * y : none;
  sums.vv += same ? none + y * y : none;
  sums.q_u += x * d;
  sums.q_v += y * d;
  sums.a_u += x * a;
  sums.a_v += y * a;
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
