#include "pipeline/algo/unwrap/order_messages.hpp"

#include <algorithm>

namespace enamel::algo {
namespace {

Cost cost(std::int32_t value) { return static_cast<Cost>(value); }

}  // namespace

void pass_gap(const OrderCosts& in, const OrderCosts& own, const GapCosts& gap, OrderCosts& out) noexcept {
  constexpr auto kStates = static_cast<std::int32_t>(kOrderStates);
  const Cost low = least(in), most = std::max(gap.above, gap.below);
  std::array<Cost, kOrderStates + 1> up_to{}, from{};  // least of in[0 … i-1], of in[i … 15]
  up_to[0] = from[kOrderStates] = most;
  for (std::size_t i = 0; i < kOrderStates; ++i) up_to[i + 1] = std::min(up_to[i], cost(in.of[i] - low));
  for (std::size_t i = kOrderStates; i-- > 0;) from[i] = std::min(from[i + 1], cost(in.of[i] - low));
  OrderCosts sum;
  for (std::int32_t j = 0; j < kStates; ++j) {
    const std::int32_t fit = j - gap.lean;
    const auto below = static_cast<std::size_t>(std::clamp(fit, 0, kStates));
    const auto above = static_cast<std::size_t>(std::clamp(fit + 1, 0, kStates));
    const bool inside = fit >= 0 && fit < kStates;
    const Cost same = inside ? cost(in.of[static_cast<std::size_t>(fit)] - low) : most;
    const Cost apart = std::min(cost(up_to[below] + gap.above), cost(from[above] + gap.below));
    sum.of[static_cast<std::size_t>(j)] = cost(own.of[static_cast<std::size_t>(j)] + std::min({same, apart, most}));
  }
  out = sum;
}

}  // namespace enamel::algo
