// What pass_gap of order_messages.hpp is, for the instruction set of whoever calls. Private to pipeline/decode/unwrap.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "pipeline/decode/unwrap/order_messages.hpp"

namespace enamel::pipeline {

/// Least of the lanes up to each, and of those from each on; `top` is no less than any.
[[gnu::always_inline]] inline CostHalf least_up_to(CostHalf a, CostHalf top) {
  a = lesser(a, __builtin_shufflevector(top, a, 0, 8, 9, 10, 11, 12, 13, 14));
  a = lesser(a, __builtin_shufflevector(top, a, 0, 1, 8, 9, 10, 11, 12, 13));
  return lesser(a, __builtin_shufflevector(top, a, 0, 1, 2, 3, 8, 9, 10, 11));
}

[[gnu::always_inline]] inline CostHalf least_from(CostHalf a, CostHalf top) {
  a = lesser(a, __builtin_shufflevector(top, a, 9, 10, 11, 12, 13, 14, 15, 0));
  a = lesser(a, __builtin_shufflevector(top, a, 10, 11, 12, 13, 14, 15, 0, 1));
  return lesser(a, __builtin_shufflevector(top, a, 12, 13, 14, 15, 0, 1, 2, 3));
}

[[gnu::always_inline]] inline void pass_gap_here(const OrderCosts& in, const OrderCosts& own, const GapCosts& gap,
                                                 OrderCosts& out) noexcept {
  const CostPair said(in);
  const CostHalf low = least_everywhere(said), most = CostHalf{} + std::max(gap.above, gap.below);
  const CostHalf above = CostHalf{} + gap.above, below = CostHalf{} + gap.below;
  const CostHalf same_low = lesser(said.low - low, most), same_high = lesser(said.high - low, most);
  const CostHalf up_low = least_up_to(same_low, most), from_high = least_from(same_high, most);
  const CostHalf up_high =
      lesser(least_up_to(same_high, most), __builtin_shufflevector(up_low, up_low, 7, 7, 7, 7, 7, 7, 7, 7));
  const CostHalf from_low =
      lesser(least_from(same_low, most), __builtin_shufflevector(from_high, from_high, 0, 0, 0, 0, 0, 0, 0, 0));
  // What a state costs that fits each partner state, and beyond their ends: all partner states lie on one side there.
  std::array<CostHalf, 6> fitting{below,
                                  below,
                                  lesser(same_low, lesser(up_low + above, from_low + below)),
                                  lesser(same_high, lesser(up_high + above, from_high + below)),
                                  above,
                                  above};
  const auto* first = reinterpret_cast<const std::byte*>(fitting.data());
  first += static_cast<std::ptrdiff_t>(sizeof(Cost)) * (kStates - std::clamp(gap.lean, -kStates, kStates));
  CostHalf fit_low, fit_high;
  std::memcpy(&fit_low, first, sizeof fit_low);
  std::memcpy(&fit_high, first + sizeof fit_low, sizeof fit_high);
  CostPair sum(own);
  sum.low += lesser(fit_low, most);
  sum.high += lesser(fit_high, most);
  sum.store(out);
}

}  // namespace enamel::pipeline
