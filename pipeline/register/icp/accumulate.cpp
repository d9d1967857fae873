#include "pipeline/register/icp/accumulate.hpp"

#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/register/icp/accumulate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "pipeline/register/icp/accumulate_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
// Eight samples at a time, in one vector or in two: the same arithmetic on every processor, nothing fused.
using Floats = hn::CappedTag<float, kLanes>;
using Ints = hn::RebindToSigned<Floats>;
using Vf = hn::Vec<Floats>;
using Vi = hn::Vec<Ints>;
using Mask = hn::Mask<Floats>;

struct Vectors {
  Vf x, y, z;
};

[[gnu::always_inline]] inline Vf set(float x) { return hn::Set(Floats(), x); }
[[gnu::always_inline]] inline Vf dot(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
[[gnu::always_inline]] inline Vectors minus(const Vectors& a, const Vectors& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
[[gnu::always_inline]] inline Vectors turned(const FloatMotion& T, const Vectors& p) {
  return {dot({set(T.r[0]), set(T.r[1]), set(T.r[2])}, p), dot({set(T.r[3]), set(T.r[4]), set(T.r[5])}, p),
          dot({set(T.r[6]), set(T.r[7]), set(T.r[8])}, p)};
}
[[gnu::always_inline]] inline Vectors moved(const FloatMotion& T, const Vectors& p) {
  const Vectors q = turned(T, p);
  return {hn::Add(q.x, set(T.t[0])), hn::Add(q.y, set(T.t[1])), hn::Add(q.z, set(T.t[2]))};
}

/// Where samples fall on the reference; index counts its floats, 0 where they fall on none.
struct Fallen {
  Mask on;
  Vi index;
};
[[gnu::always_inline]] inline Fallen associate(const AlignLanes& in, const Vectors& p_cam) {
  const Floats d;
  const Ints di;
  const Vectors p = moved(in.to_view, p_cam);
  const Vf inverse = hn::Div(set(1), p.z);
  const auto pixel = [&](float f, float c, Vf along) {
    return hn::Add(hn::Mul(hn::Add(hn::Mul(set(f), hn::Mul(along, inverse)), set(c)), set(in.scale)), set(0.5F));
  };
  const Vf u = pixel(in.fx, in.cx, p.x), v = pixel(in.fy, in.cy, p.y);
  const Mask inside =
      hn::And(hn::And(hn::Gt(p.z, set(1)), hn::And(hn::Ge(u, hn::Zero(d)), hn::Ge(v, hn::Zero(d)))),
              hn::And(hn::Lt(u, set(static_cast<float>(in.width))), hn::Lt(v, set(static_cast<float>(in.height)))));
  const Vi column = hn::ConvertTo(di, hn::IfThenElseZero(inside, u));
  const Vi row = hn::ConvertTo(di, hn::IfThenElseZero(inside, v));
  const Vi index = hn::Add(hn::Mul(row, hn::Set(di, in.width)), column);
  return {inside, hn::Mul(index, hn::Set(di, AlignLanes::kPixelFloats))};
}

[[gnu::always_inline]] inline Vectors gathered(const float* pixels, Vi index) {
  const Floats d;
  return {hn::GatherIndex(d, pixels, index), hn::GatherIndex(d, pixels + 1, index),
          hn::GatherIndex(d, pixels + 2, index)};
}

/// As RobustKernel::weight.
[[gnu::always_inline]] inline Vf kernel_weight(const RobustKernel& kernel, Vf abs_e) {
  const Vf r = hn::Mul(abs_e, set(kernel.inv_scale));
  if (!kernel.welsch) return hn::Div(set(1), hn::Max(r, set(1)));
  const Vf t = hn::Div(set(1), hn::Add(set(1), hn::Mul(hn::Mul(set(0.25F), r), r)));
  const Vf t2 = hn::Mul(t, t);
  return hn::Mul(t2, t2);
}

/// Adds w a b to the sum with this number.
[[gnu::always_inline]] inline void add(LaneSums& sums, std::size_t n, std::size_t lane, Vf product) {
  const Floats d;
  float* at = sums.of[n].data() + lane;
  hn::Store(hn::Add(hn::Load(d, at), product), d, at);
}

/// The upper triangle of w J J^T row by row, then w e J, then w.
[[gnu::always_inline]] inline void add_system(LaneSums& sums, std::size_t lane, const std::array<Vf, 6>& J, Vf e,
                                              Vf w) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const Vf wi = hn::Mul(w, J[i]);
    for (std::size_t k = i; k < 6; ++k) add(sums, n++, lane, hn::Mul(wi, J[k]));
    add(sums, LaneSums::kGradient + i, lane, hn::Mul(wi, e));
  }
  add(sums, LaneSums::kKernelWeight, lane, w);
}

/// Samples `lane` … of eight. valid: how many of the eight there are.
[[gnu::always_inline]] inline void judge(const AlignLanes& in, const SamplePointers& s, std::size_t lane,
                                         std::size_t valid, LaneSums& sums) {
  const Floats d;
  const Ints di;
  const std::size_t there = valid > lane ? std::min(valid - lane, hn::Lanes(d)) : 0;
  std::int32_t* bins = sums.bins.data() + lane;
  hn::StoreU(hn::Set(di, ResidualHistogram::kNoBin), di, bins);
  const Vectors p_cam{hn::LoadU(d, s.x + lane), hn::LoadU(d, s.y + lane), hn::LoadU(d, s.z + lane)};
  const Fallen fallen = associate(in, p_cam);
  const Mask inside = hn::And(fallen.on, hn::FirstN(d, there));
  if (hn::AllFalse(d, inside)) return;
  const Vectors point = gathered(in.pixels, fallen.index);
  const Mask known = hn::And(inside, hn::Eq(point.x, point.x));
  const Vectors normal = gathered(in.pixels + 4, fallen.index);
  const Vectors p = moved(in.to_model, p_cam);
  const Vectors apart = minus(p, point);
  const Vectors own =
      turned(in.to_model, {hn::LoadU(d, s.nx + lane), hn::LoadU(d, s.ny + lane), hn::LoadU(d, s.nz + lane)});
  // Rusinkiewicz 2019: between the two normals the distance is exact on any constant curvature. By the pixel's alone a
  // sample half a pixel beside it is off by its sagitta, to the same side everywhere.
  const Vf e =
      hn::Mul(set(0.5F), dot({hn::Add(normal.x, own.x), hn::Add(normal.y, own.y), hn::Add(normal.z, own.z)}, apart));
  const Vf abs_e = hn::Abs(e);
  const Mask agree = hn::And(hn::Lt(abs_e, set(in.gate.distance_mm)),
                             hn::And(hn::Le(dot(apart, apart), set(in.gate.distance3d_mm * in.gate.distance3d_mm)),
                                     hn::Ge(dot(normal, own), set(in.gate.min_cos))));
  const Mask match = hn::And(known, agree);
  const Vectors axis{set(in.axis[0]), set(in.axis[1]), set(in.axis[2])};
  const Mask hidden = hn::Gt(dot(axis, apart), set(in.gate.hidden_mm));
  sums.contradictions += hn::CountTrue(d, hn::AndNot(hn::Or(agree, hidden), known));
  if (hn::AllFalse(d, match)) return;
  sums.matches += hn::CountTrue(d, match);
  const Vectors arm = minus(p, {set(in.centre[0]), set(in.centre[1]), set(in.centre[2])});
  const auto lever = [&](Vf a, Vf b, Vf c, Vf f) {
    return hn::IfThenElseZero(match, hn::Mul(hn::Sub(hn::Mul(a, b), hn::Mul(c, f)), set(in.inv_rho)));
  };
  const std::array<Vf, 6> J{lever(arm.y, normal.z, arm.z, normal.y), lever(arm.z, normal.x, arm.x, normal.z),
                            lever(arm.x, normal.y, arm.y, normal.x), hn::IfThenElseZero(match, normal.x),
                            hn::IfThenElseZero(match, normal.y),     hn::IfThenElseZero(match, normal.z)};
  const Vf known_e = hn::IfThenElseZero(match, e);
  const Vf weight = hn::IfThenElseZero(match, hn::LoadU(d, s.weight + lane));
  add_system(sums, lane, J, known_e, hn::Mul(weight, hn::IfThenElseZero(match, kernel_weight(in.kernel, abs_e))));
  add(sums, LaneSums::kWeight, lane, weight);
  add(sums, LaneSums::kWeightedE2, lane, hn::Mul(hn::Mul(weight, known_e), known_e));
  const Vf bin = hn::Min(hn::Mul(hn::IfThenElseZero(match, abs_e), set(1000)), set(ResidualHistogram::kLastBin));
  hn::StoreU(hn::IfThenElse(hn::RebindMask(di, match), hn::ConvertTo(di, bin), hn::Set(di, ResidualHistogram::kNoBin)),
             di, bins);
}

void judge_eight(const AlignLanes& in, const SamplePointers& samples, std::size_t count, ResidualHistogram& residuals,
                 LaneSums& sums) {
  SamplePointers at = samples;
  for (std::size_t i = 0; i < count; i += kLanes, at.advance(kLanes)) {
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(Floats())) judge(in, at, lane, count - i, sums);
    residuals.add_bins(sums.bins);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(judge_eight);

AlignPass accumulate(const Alignment& of, const Pose& T_model_cam, const MatchGate& gate, const RobustKernel& kernel) {
  const AlignLanes in(of, T_model_cam, gate, kernel);
  const std::size_t size = of.samples.size(), whole = size / kLanes * kLanes;
  AlignPass pass;
  DoubleSums total;
  LaneSums sums;
  for (std::size_t first = 0; first < whole; first += kLaneSamples * kLanes) {
    const std::size_t count = std::min(kLaneSamples * kLanes, whole - first);
    HWY_DYNAMIC_DISPATCH(judge_eight)(in, SamplePointers(of.samples, first), count, pass.residuals, sums);
    total.take(sums);
  }
  if (whole < size) {
    const LastSamples last(of.samples, whole);
    HWY_DYNAMIC_DISPATCH(judge_eight)(in, last.pointers(), size - whole, pass.residuals, sums);
    total.take(sums);
  }
  total.put(pass);
  pass.matches = sums.matches;
  pass.contradictions = sums.contradictions;
  return pass;
}

}  // namespace enamel::pipeline
#endif
