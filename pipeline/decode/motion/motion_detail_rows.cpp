#include "pipeline/decode/motion/motion_detail_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pipeline/decode/motion/chosen.hpp"
#include "pipeline/decode/motion/motion_samples.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/motion/motion_detail_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "pipeline/decode/motion/slope_pairs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// derived: dz/dx of 75 degrees, the steepest that counts as one surface (LinkConfig).
constexpr float kSteepest = 3.7F;

using DetailLanes = std::array<float, kNodeLanes>;

[[gnu::always_inline]] inline DetailLanes spread(const Lanes& lanes) {
  DetailLanes out;
  std::memcpy(out.data(), &lanes, sizeof lanes);
  return out;
}

/// Equations of rigid_motion.hpp with the motion put in.
[[gnu::always_inline]] inline void motion_of(const PairSums<DetailLanes>& s, const DetailMotion& t, const float* q_at,
                                             const float* light_at, const DetailRow& row, const NodePlace& at) {
  const auto begin = static_cast<std::size_t>(at.begin);
  const int right_px = 2 * at.x - kNode_px, down_px = 2 * at.y;  // of the node
  static_assert(kNode_px % 2 == 0);
  const auto right = static_cast<float>(right_px), down = static_cast<float>(down_px);
  const float* __restrict q_of = q_at, * __restrict light_of = light_at;
  const float* __restrict x_of = row.x + begin, * __restrict y_of = row.y + begin, * __restrict slope = row.slope + begin;
  const float* __restrict step_x = row.step_x + begin, * __restrict step_y = row.step_y + begin;
  float* __restrict rate = row.rate + begin, * __restrict growth = row.light + begin;
  ENAMEL_INDEPENDENT
  for (std::size_t j = 0; j < kNodeLanes; ++j) {
    const float det = s.uu[j] * s.vv[j] - s.uv[j] * s.uv[j], in_x = 1 / (det * step_x[j]);
    const float in_y = 1 / (det * step_y[j]);
    const float q = q_of[j], x = x_of[j] + right * step_x[j], y = y_of[j] + down * step_y[j], light = light_of[j];
    const float m_x = (s.vv[j] * s.q_u[j] - s.uv[j] * s.q_v[j]) * in_x;
    const float m_y = (s.uu[j] * s.q_v[j] - s.uv[j] * s.q_u[j]) * in_y, m_z = q - m_x * x - m_y * y;
    const float a_x = (s.vv[j] * s.a_u[j] - s.uv[j] * s.a_v[j]) * in_x;
    const float a_y = (s.uu[j] * s.a_v[j] - s.uv[j] * s.a_u[j]) * in_y;
    // U q, the point's motion; l q, from it to the projector.
    const float arm = 1 - q * t.about_mm;
    const float u_x = q * t.shift_mm[0] + t.turn_rad[1] * arm - t.turn_rad[2] * y;
    const float u_y = q * t.shift_mm[1] + t.turn_rad[2] * x - t.turn_rad[0] * arm;
    const float u_z = q * t.shift_mm[2] + t.turn_rad[0] * y - t.turn_rad[1] * x;
    const float l_x = q * t.projector_mm[0] - x, l_y = q * t.projector_mm[1] - y, l_z = q * t.projector_mm[2] - 1;
    const float along = m_x * u_x + m_y * u_y + m_z * u_z;
    const float distance2 = l_x * l_x + l_y * l_y + l_z * l_z, m2 = m_x * m_x + m_y * m_y + m_z * m_z;
    const float grazing = -kMinLitCosine * root(m2 * distance2);
    const float facing = smaller(m_x * l_x + m_y * l_y + m_z * l_z, grazing);
    const float falloff = 4 / (1 + x * x + y * y);
    const float passing =
        -((a_x / light + falloff * x) * (u_x - x * u_z) + (a_y / light + falloff * y) * (u_y - y * u_z));
    const float nearer = 7 * (l_x * u_x + l_y * u_y + l_z * u_z) / distance2;
    const float aside = -4 * (t.projector_axis[0] * u_x + t.projector_axis[1] * u_y + t.projector_axis[2] * u_z) /
                        (t.projector_axis[0] * l_x + t.projector_axis[1] * l_y + t.projector_axis[2] * l_z);
    const float turning = t.turn_rad[0] * (m_y * l_z - m_z * l_y) + t.turn_rad[1] * (m_z * l_x - m_x * l_z) +
                          t.turn_rad[2] * (m_x * l_y - m_y * l_x);
    const float change = passing + nearer + aside + (turning - along) / facing;
    const float steepness = std::abs(slope[j]);
    const bool known = (q > 0) & (det > kMinDetailDet) & (light > 1) & (steepness > 0);
    rate[j] = select(known, -along / slope[j], rate[j]);
    growth[j] = select(known, smaller(larger(change, -kMostGrowth), kMostGrowth), growth[j]);
  }
}

void detail_loop(const MotionImages& images, int node_row, int place_x, int place_y, int count,
                 const DetailMotion& motion, const DetailRow& row) {
  constexpr auto kLanes = static_cast<int>(kNodeLanes);
  const int beside = place_x + kNode_px / 2;  // a node further on: arrays begin at node 1
  for (int n = 0; n < count; n += kLanes) {
    const NodePlace at{node_row, beside, place_y, std::max(std::min(n, count - kLanes), 0)};
    const auto begin = static_cast<std::size_t>(at.begin);
    const float* q = images.inverse_depth.around(node_row, beside, place_y) + at.begin;
    const float* light = images.light.around(node_row, beside, place_y) + at.begin;
    DetailLanes limits;
    for (std::size_t j = 0; j < kNodeLanes; ++j) limits[j] = kSteepest * q[j] * std::abs(row.step_x[begin + j]);
    Lanes limit;
    load(limits.data(), limit);
    PairSums<Lanes> pairs;
    for (int dy = 0; dy <= kDetailReach; ++dy) {
      for (int dx = dy == 0 ? 1 : -kDetailReach; dx <= kDetailReach; ++dx) add_pairs(images, at, dx, dy, limit, pairs);
    }
    const PairSums<DetailLanes> sums{spread(pairs.uu),  spread(pairs.uv),  spread(pairs.vv), spread(pairs.q_u),
                                     spread(pairs.q_v), spread(pairs.a_u), spread(pairs.a_v)};
    motion_of(sums, motion, q, light, row, at);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(detail_loop);

void detail_row(const MotionImages& images, int node_row, int place_x, int place_y, int count,
                const DetailMotion& motion, const DetailRow& row) {
  HWY_DYNAMIC_DISPATCH(detail_loop)(images, node_row, place_x, place_y, count, motion, row);
}

}  // namespace enamel::pipeline
#endif
