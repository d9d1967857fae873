#include "pipeline/algo/unwrap/order_messages.hpp"

#include <algorithm>

namespace enamel::algo {
namespace {

Cost cost(std::int32_t value) { return static_cast<Cost>(value); }

void subtract(Cost low, OrderCosts& costs) {
  for (Cost& c : costs.of) c = cost(c - low);
}

}  // namespace

Cost least(const OrderCosts& costs) noexcept {
  std::array<Cost, kOrderStates / 2> m;
  for (std::size_t k = 0; k < m.size(); ++k) m[k] = std::min(costs.of[k], costs.of[k + m.size()]);
  for (std::size_t n = m.size() / 2; n > 0; n /= 2)
    for (std::size_t k = 0; k < n; ++k) m[k] = std::min(m[k], m[k + n]);
  return m[0];
}

void pass_joined(const OrderCosts& in, const OrderCosts& own, Cost jump, OrderCosts& out) noexcept {
  const Cost low = least(in);
  OrderCosts sum;  // apart from in and out, which may be the same: the loops vectorise
  for (std::size_t k = 0; k < kOrderStates; ++k) sum.of[k] = cost(own.of[k] + std::min(cost(in.of[k] - low), jump));
  subtract(least(sum), sum);
  out = sum;
}

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
  subtract(least(sum), sum);
  out = sum;
}

void blend(const OrderCosts& before, const OrderCosts& own, float memory, Cost most, OrderCosts& out) noexcept {
  // Weights in 2^-15, the result rounded down.
  const auto old_share = static_cast<std::int32_t>(memory * 32768), own_share = 32768 - old_share;
  const Cost low = least(before), own_low = least(own);
  OrderCosts sum;
  for (std::size_t k = 0; k < kOrderStates; ++k) {
    const std::int32_t was = std::min(cost(before.of[k] - low), most), is = own.of[k] - own_low;
    sum.of[k] = cost((was * old_share + is * own_share) >> 15);
  }
  out = sum;
}

}  // namespace enamel::algo
