#include "pipeline/model/fuse/integrate_block.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "pipeline/model/fuse/integrate_limits.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/model/fuse/integrate_block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
// Eight voxels along x at a time, in one vector or in two: the same arithmetic on every processor, nothing fused.
using Floats = hn::CappedTag<float, kBlockEdge>;
using Ints = hn::RebindToSigned<Floats>;
using Vf = hn::Vec<Floats>;
using Vi = hn::Vec<Ints>;
using Bytes = hn::CappedTag<std::uint8_t, kBlockEdge>;

constexpr int kSurfelFloats = sizeof(Surfel) / sizeof(float);
static_assert(sizeof(Surfel) == kSurfelFloats * sizeof(float) && offsetof(Surfel, support) == 5 * sizeof(float));

/// What the patch says about the eight voxels of a row; weight 0 = nothing.
struct Measured {
  HWY_ALIGN std::array<float, kBlockEdge> distance, weight;
  HWY_ALIGN std::array<std::uint8_t, kBlockEdge> support;
};

struct Points {
  Vf x, y, z;
};

[[gnu::always_inline]] inline Vf pixel_coordinate(float first, float along_x, float along_y, const Points& p,
                                                  Vf inverse_z) {
  const Floats d;
  const Vf slope = hn::Add(hn::Mul(hn::Set(d, along_x), p.x), hn::Mul(hn::Set(d, along_y), p.y));
  // + 1.5 before the truncation: rounds to the nearest pixel, and what lies left of the picture stays below 1.
  return hn::Add(hn::Add(hn::Set(d, first), hn::Mul(slope, inverse_z)), hn::Set(d, 1.5F));
}

/// Element `field` of the surfels at `index`.
template <class D>
[[gnu::always_inline]] inline hn::Vec<D> gather(D d, const Surfel* surfels, int field, Vi index) {
  return hn::GatherIndex(d, reinterpret_cast<const hn::TFromD<D>*>(surfels) + field, index);
}

/// Voxels `first` … of the row that begins at `start`; the number of them that the patch measures.
[[gnu::always_inline]] inline std::size_t measure(const SurfelPicture& picture, const BlockInCamera& at,
                                                  const Vec3f& start, std::size_t first, const IntegrateLimits& limits,
                                                  Measured& out) {
  const Floats d;
  const Ints di;
  const Vf k = hn::Iota(d, static_cast<float>(first));
  const Points p{hn::Add(hn::Set(d, start.x()), hn::Mul(k, hn::Set(d, at.step_x.x()))),
                 hn::Add(hn::Set(d, start.y()), hn::Mul(k, hn::Set(d, at.step_x.y()))),
                 hn::Add(hn::Set(d, start.z()), hn::Mul(k, hn::Set(d, at.step_x.z())))};
  const LocalProjection& local = at.projection;
  const Vf inverse = hn::Div(hn::Set(d, 1.0F), p.z);
  const Vf u = pixel_coordinate(local.u0, local.uX, local.uY, p, inverse);
  const Vf v = pixel_coordinate(local.v0, local.vX, local.vY, p, inverse);
  const Vf one = hn::Set(d, 1.0F);
  const auto inside = hn::And(hn::And(hn::Ge(u, one), hn::Ge(v, one)),
                              hn::And(hn::Lt(u, hn::Set(d, static_cast<float>(picture.width + 1))),
                                      hn::Lt(v, hn::Set(d, static_cast<float>(picture.height + 1)))));
  hn::Store(hn::Zero(d), d, out.weight.data() + first);
  const hn::Rebind<std::uint8_t, Floats> db;
  hn::StoreU(hn::Zero(db), db, out.support.data() + first);
  if (hn::AllFalse(d, inside)) return 0;
  const Vi column = hn::ConvertTo(di, hn::IfThenElse(inside, u, one));
  const Vi row = hn::ConvertTo(di, hn::IfThenElse(inside, v, one));
  const Vi pixel = hn::Add(hn::Mul(hn::Sub(row, hn::Set(di, 1)), hn::Set(di, picture.width)), column);
  const Vi index = hn::Mul(hn::Sub(pixel, hn::Set(di, 1)), hn::Set(di, kSurfelFloats));
  const Vf along = hn::Add(
      hn::Add(hn::Mul(gather(d, picture.surfels, 0, index), p.x), hn::Mul(gather(d, picture.surfels, 1, index), p.y)),
      hn::Mul(gather(d, picture.surfels, 2, index), p.z));
  const Vf distance = hn::Sub(along, gather(d, picture.surfels, 3, index));
  const Vf above = hn::Add(hn::Set(d, limits.truncation), distance);
  const auto near =
      hn::And(hn::And(inside, hn::Le(distance, hn::Set(d, limits.truncation))), hn::Gt(above, hn::Zero(d)));
  if (hn::AllFalse(d, near)) return 0;
  const Vf weight = gather(d, picture.surfels, 4, index);
  const auto ok = hn::And(near, hn::Gt(weight, hn::Zero(d)));
  const Vf faded = hn::Mul(weight, hn::Min(one, hn::Mul(above, hn::Set(d, limits.fade))));
  hn::Store(hn::IfThenElseZero(ok, distance), d, out.distance.data() + first);
  hn::Store(hn::IfThenElseZero(ok, faded), d, out.weight.data() + first);
  const Vi support = hn::IfThenElseZero(hn::RebindMask(di, ok), gather(di, picture.surfels, 5, index));
  hn::StoreU(hn::DemoteTo(db, support), db, out.support.data() + first);
  return hn::CountTrue(d, ok);
}

/// Running means; `moved` collects how far each zero crossing may have shifted.
[[gnu::always_inline]] inline void update_distances(const Measured& in, const IntegrateLimits& limits, float* distances,
                                                    float* weights, float* moved) {
  const Floats d;
  for (std::size_t i = 0; i < kBlockEdge; i += hn::Lanes(d)) {
    const Vf added = hn::Load(d, in.weight.data() + i);
    const Vf before = hn::LoadU(d, distances + i);
    const Vf sum = hn::Add(hn::LoadU(d, weights + i), added);
    const Vf share = hn::Div(added, hn::IfThenElse(hn::Gt(sum, hn::Zero(d)), sum, hn::Set(d, 1.0F)));
    const Vf change = hn::Mul(hn::Sub(hn::Load(d, in.distance.data() + i), before), share);
    const Vf after = hn::Add(before, change);
    hn::StoreU(after, d, distances + i);
    hn::StoreU(hn::Min(sum, hn::Set(d, limits.weight_max)), d, weights + i);
    const auto at_surface = hn::Lt(hn::Abs(after), hn::Set(d, limits.near_surface));
    hn::Store(hn::Max(hn::Load(d, moved + i), hn::IfThenElseZero(at_surface, hn::Abs(change))), d, moved + i);
  }
}

[[gnu::always_inline]] inline void update_counts(const Measured& in, const IntegrateLimits& limits, std::size_t first,
                                                 Block& block) {
  const Bytes d;
  const auto least_seen = hn::Set(d, limits.min_observations);
  const auto least_bursts = hn::Set(d, limits.min_bursts);
  for (std::size_t i = 0; i < kBlockEdge; i += hn::Lanes(d)) {
    std::uint8_t* const observations = &block.observations[first + i];
    std::uint8_t* const bursts = &block.bursts[first + i];
    const auto added = hn::Load(d, in.support.data() + i);
    const auto seen = hn::LoadU(d, observations);
    const auto times = hn::LoadU(d, bursts);
    const auto seen_now = hn::SaturatedAdd(seen, added);
    const auto times_now = hn::SaturatedAdd(times, hn::Min(added, hn::Set(d, 1)));
    hn::StoreU(seen_now, d, observations);
    hn::StoreU(times_now, d, bursts);
    const auto was = hn::And(hn::Eq(hn::Max(seen, least_seen), seen), hn::Eq(hn::Max(times, least_bursts), times));
    const auto is =
        hn::And(hn::Eq(hn::Max(seen_now, least_seen), seen_now), hn::Eq(hn::Max(times_now, least_bursts), times_now));
    block.confirmed = block.confirmed || !hn::AllFalse(d, is);
    block.grown = block.grown || !hn::AllFalse(d, hn::AndNot(was, is));
  }
}

std::uint64_t integrate_rows(const SurfelPicture& picture, const BlockInCamera& at, const IntegrateLimits& limits,
                             Block& block) {
  const Floats d;
  std::uint64_t updated = 0;
  HWY_ALIGN std::array<float, kBlockEdge> moved{};
  Measured measured{};
  for (std::size_t row = 0; row < kBlockEdge * kBlockEdge; ++row) {
    const auto ky = static_cast<float>(static_cast<std::int32_t>(row % kBlockEdge));
    const auto kz = static_cast<float>(static_cast<std::int32_t>(row / kBlockEdge));
    const Vec3f start(at.origin.x() + ky * at.step_y.x() + kz * at.step_z.x(),
                      at.origin.y() + ky * at.step_y.y() + kz * at.step_z.y(),
                      at.origin.z() + ky * at.step_y.z() + kz * at.step_z.z());
    std::size_t count = 0;
    for (std::size_t i = 0; i < kBlockEdge; i += hn::Lanes(d))
      count += measure(picture, at, start, i, limits, measured);
    if (count == 0) continue;
    const std::size_t first = row * kBlockEdge;
    update_distances(measured, limits, &block.distance_mm[first], &block.weight[first], moved.data());
    update_counts(measured, limits, first, block);
    updated += count;
  }
  block.moved_mm += *std::max_element(moved.begin(), moved.end());
  return updated;
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(integrate_rows);

std::uint64_t integrate_block(const SurfelMap& surfels, const BlockInCamera& at, const FuseConfig& config,
                              Block& block) {
  return HWY_DYNAMIC_DISPATCH(integrate_rows)({&surfels[0], surfels.width(), surfels.height()}, at, limits_of(config),
                                              block);
}

}  // namespace enamel::pipeline
#endif
