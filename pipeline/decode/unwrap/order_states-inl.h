// Costs of a segment's sixteen states in registers; compiled once per instruction set. What the messages of
// order_messages.hpp are made of. Private to pipeline/decode/unwrap.
#if defined(ENAMEL_ORDER_STATES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENAMEL_ORDER_STATES_INL_H_
#undef ENAMEL_ORDER_STATES_INL_H_
#else
#define ENAMEL_ORDER_STATES_INL_H_
#endif

#include <hwy/highway.h>

#include "pipeline/decode/unwrap/order_messages.hpp"

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using StateTag = hn::CappedTag<Cost, kOrderStates>;
using StateLanes = hn::Vec<StateTag>;
inline constexpr std::size_t kLanes = hn::MaxLanes(StateTag());
inline constexpr std::size_t kParts = kOrderStates / kLanes;  ///< registers for all states

/// The least of a register's lanes, in every lane. None may be negative.
HWY_INLINE StateLanes least_of_lanes(StateLanes costs) {
  const StateTag tag;
#if HWY_MAX_BYTES >= 32
  const hn::Half<StateTag> half;
  const hn::RebindToUnsigned<hn::Half<StateTag>> whole;
  const auto lesser_half = hn::Min(hn::LowerHalf(half, costs), hn::UpperHalf(half, costs));
  const auto least = hn::BitCast(half, hn::MinOfLanes(whole, hn::BitCast(whole, lesser_half)));
  return hn::Combine(tag, least, least);
#else
  const hn::RebindToUnsigned<StateTag> whole;
  return hn::BitCast(tag, hn::MinOfLanes(whole, hn::BitCast(whole, costs)));
#endif
}

struct States {
  StateLanes part[kParts];  ///< no std::array: its members are not compiled for this instruction set

  HWY_INLINE States() {}

  /// of(p, ...): what becomes of part p of each.
  template <class Of, class... Others>
  static HWY_INLINE States each(Of of, const Others&... others) {
    States out;
    for (std::size_t p = 0; p < kParts; ++p) out.part[p] = of(others.part[p]...);
    return out;
  }
  static HWY_INLINE States load(const OrderCosts& costs) {
    States out;
    for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::Load(StateTag(), costs.of.data() + p * kLanes);
    return out;
  }
  HWY_INLINE void store(OrderCosts& out) const {
    for (std::size_t p = 0; p < kParts; ++p) hn::Store(part[p], StateTag(), out.of.data() + p * kLanes);
  }
  /// In every lane.
  [[nodiscard]] HWY_INLINE StateLanes least() const {
    StateLanes lesser_part = part[0];
    for (std::size_t p = 1; p < kParts; ++p) lesser_part = hn::Min(lesser_part, part[p]);
    return least_of_lanes(lesser_part);
  }
};

/// Along a surface: own[k] + min(in[k] - min(in), jump), as pass_joined.
HWY_INLINE States passed_on(const States& in, const States& own, StateLanes jump) {
  const StateLanes low = in.least();
  return States::each([&](auto a, auto b) HWY_ATTR { return hn::Add(b, hn::Min(hn::Sub(a, low), jump)); }, in, own);
}

HWY_INLINE States levelled(const States& costs) {
  const StateLanes low = costs.least();
  return States::each([&](auto a) HWY_ATTR { return hn::Sub(a, low); }, costs);
}

HWY_INLINE States mean_of_states(const States& a, const States& b) {
  return States::each([](auto x, auto y) HWY_ATTR { return hn::ShiftRight<1>(hn::Add(x, y)); }, a, b);
}

/// As blend; share: to_share() of the memory.
HWY_INLINE States blended(const States& before, const States& own, StateLanes share, StateLanes most) {
  const StateLanes low = before.least();
  return States::each(
      [&](auto a, auto is) HWY_ATTR {
        const auto more = hn::Sub(hn::Min(hn::Sub(a, low), most), is);
        return hn::Add(is, hn::MulHigh(hn::Add(more, more), share));
      },
      before, own);
}

/// As cheapest.
HWY_INLINE Choice cheapest_state(const States& costs) {
  const StateTag tag;
  const StateLanes none = hn::Set(tag, static_cast<Cost>(kOrderStates)), impossible = hn::Set(tag, kImpossible);
  States number;
  for (std::size_t p = 0; p < kParts; ++p) number.part[p] = hn::Iota(tag, static_cast<Cost>(p * kLanes));
  const StateLanes first = costs.least();
  const States place = States::each(
      [&](auto cost, auto state) HWY_ATTR { return hn::IfThenElse(hn::Eq(cost, first), state, none); }, costs, number);
  const StateLanes best = place.least();
  const States others = States::each([&](auto cost, auto state)
                                         HWY_ATTR { return hn::IfThenElse(hn::Eq(state, best), impossible, cost); },
                                     costs, number);
  const Cost least = hn::GetLane(first);
  return {hn::GetLane(best), least, static_cast<Cost>(hn::GetLane(others.least()) - least)};
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
