#include "pipeline/decode/unwrap/order_messages.hpp"

#include "pipeline/decode/unwrap/order_gap.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/unwrap/order_messages.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "pipeline/decode/unwrap/order_states-inl.h"

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void one_joined(const OrderCosts& in, const OrderCosts& own, Cost jump, OrderCosts& out) {
  passed_on(States::load(in), States::load(own), hn::Set(StateTag(), jump)).store(out);
}

void one_gap(const OrderCosts& in, const OrderCosts& own, const GapCosts& gap, OrderCosts& out) {
  pass_gap_here(in, own, gap, out);
}

void one_level(const OrderCosts& costs, OrderCosts& out) { levelled(States::load(costs)).store(out); }

void one_blend(const OrderCosts& before, const OrderCosts& own, float memory, Cost most, OrderCosts& out) {
  const StateTag tag;
  blended(States::load(before), States::load(own), hn::Set(tag, to_share(memory)), hn::Set(tag, most)).store(out);
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(one_joined);
HWY_EXPORT(one_gap);
HWY_EXPORT(one_level);
HWY_EXPORT(one_blend);

void pass_joined(const OrderCosts& in, const OrderCosts& own, Cost jump, OrderCosts& out) {
  HWY_DYNAMIC_DISPATCH(one_joined)(in, own, jump, out);
}

void pass_gap(const OrderCosts& in, const OrderCosts& own, const GapCosts& gap, OrderCosts& out) {
  HWY_DYNAMIC_DISPATCH(one_gap)(in, own, gap, out);
}

void level(const CostPair& costs, OrderCosts& out) {
  costs.store(out);
  HWY_DYNAMIC_DISPATCH(one_level)(out, out);
}

void blend(const OrderCosts& before, const OrderCosts& own, float memory, Cost most, OrderCosts& out) {
  HWY_DYNAMIC_DISPATCH(one_blend)(before, own, memory, most, out);
}

}  // namespace enamel::pipeline
#endif
